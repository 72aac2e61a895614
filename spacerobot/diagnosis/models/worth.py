"""What a further parameter is worth: which of the models that were tried is chosen, and which predict as well.

Unseen trials decide, by an effect size and by a test; information criteria would keep rewarding arbitrary terms.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import stdtrit

from spacerobot.diagnosis.data import TrialData
from spacerobot.diagnosis.models.candidate import Candidate
from spacerobot.diagnosis.models.held_out import parent

WORTH_OF_REST = 0.05
WORTH_OF_BASELINE = 0.02
"""A further parameter must lower the held-out rms by these shares of itself and of the baseline's: an effect size,
for in long recordings any harmless defect is significant."""

SURE = 0.95
"""Probability, by Student's t, with which the mean gain over unseen trials must exceed zero."""

TELLING = 0.1
"""Change of the logarithm of the mean square below which a piece tells nothing: there both models are at the noise."""

TIE = 0.01
"""Rivals whose held-out rms differ by less than this share are not told apart."""

SAME = 1e-4
"""Candidates of one size whose held-out rms agree to this share are one model in two wordings."""


def choice(tested: Sequence[Candidate], baseline: Candidate, trials: Sequence[TrialData]) -> Candidate:
    """The simplest that predicts as well as the best does, as far as a further parameter is worth naming."""
    good = [c for c in tested if pays(c, baseline, trials)]
    if not good:
        return baseline
    best = min(c.error for c in good)
    near = [c for c in good if c.error <= slack(best, baseline.error)]
    simplest = min(c.size for c in near)
    first = min(c.error for c in near if c.size == simplest)
    same = [c for c in near if c.size == simplest and c.error <= (1.0 + SAME) * first]
    return min(same, key=lambda c: (sum(s.effect.kind == "sensor" for s in c.sites), len(c.sites), c.error))


def pays(new: Candidate, old: Candidate, trials: Sequence[TrialData]) -> bool:
    """Whether unseen trials are predicted better, by enough and throughout."""
    if not new.held_out or not old.held_out or not new.error < (1.0 - WORTH_OF_REST) * old.error:
        return False
    before = {k: v for h in old.held_out for k, v in h.squares().items()}
    after = {k: v for h in new.held_out for k, v in h.squares().items()}
    by_parent = len({parent(t) for t in trials}) > 3
    groups: dict[str, list[float]] = {}
    for trial in trials:
        gain = np.log(max(before[trial.id], 1e-300) / max(after[trial.id], 1e-300))
        groups.setdefault(parent(trial) if by_parent else trial.id, []).append(float(gain))
    gains = np.array([np.mean(g) for g in groups.values()])
    gains = gains[np.abs(gains) > TELLING]
    if gains.size < 3:
        return bool(gains.size and (gains > 0.0).all())
    return bool(gains.mean() > stdtrit(gains.size - 1, SURE) * gains.std(ddof=1) / np.sqrt(gains.size))


def slack(best: float, baseline: float) -> float:
    """The largest held-out rms of a model that is as good as the best one."""
    return max(best / (1.0 - WORTH_OF_REST), best + WORTH_OF_BASELINE * baseline)


def distinct(layer: Sequence[Candidate]) -> list[Candidate]:
    """Without those that say the same as one before them in other words (a preload and a bias of its sensor)."""
    kept: list[Candidate] = []
    for one in layer:
        if all(abs(one.error - k.error) > SAME * k.error for k in kept):
            kept.append(one)
    return kept
