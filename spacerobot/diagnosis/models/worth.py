"""What a further parameter is worth: which of the models that were tried is chosen, and which predict as well.

Unseen trials decide, by an effect size and by a test; information criteria would keep rewarding arbitrary terms. Two
models are compared over the trials that tell them apart: where both predict the same, however many such trials there
are, nothing is said for or against either.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

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

SPOKEN = 0.5
"""Of fewer than three telling trials, those that say at least this share of what the clearest says must all agree."""

TIE = 0.01
"""Rivals whose held-out rms differ by less than this share are not told apart."""

SAME = 1e-4
"""Candidates of one size whose held-out rms agree to this share are one model in two wordings."""


@dataclass(frozen=True, eq=False)
class Told:
    """What unseen trials say of two models. K trials.

    Attributes:
        ids: of the trials.
        one, other: mean squares of their weighted residuals, shape (K,).
        weight: how far each trial tells the two apart, shape (K,), from 0 to 1: d^2 / (d^2 + s^2), where d^2 is the
            mean square of the difference of their predictions and s^2 what the better one leaves over.
        readings: of each trial, shape (K,).
    """

    ids: tuple[str, ...]
    one: np.ndarray
    other: np.ndarray
    weight: np.ndarray
    readings: np.ndarray

    def rms(self, square: np.ndarray) -> float:
        """Root mean square over the readings of the telling trials, of mean squares by trial, shape (K,)."""
        weight = self.weight * self.readings
        return float(np.sqrt(weight @ square / max(weight.sum(), 1e-300)))

    @property
    def ratio(self) -> float:
        """Held-out rms of the one over the other's; 1 where nothing tells them apart."""
        other = self.rms(self.other)
        return self.rms(self.one) / other if other > 0.0 else 1.0


def told(one: Candidate, other: Candidate) -> Told | None:
    """What unseen trials say of two models; None where one of them was not tried."""
    if one.held_out is None or other.held_out is None:
        return None
    a, b, weight, readings = [], [], [], []
    ids = tuple(one.held_out.residual)
    for name in ids:
        new, old, count = one.held_out.residual[name], other.held_out.residual[name], one.held_out.counted[name].sum()
        readings.append(max(int(count), 1))
        apart = float(np.sum((new - old) ** 2))
        a.append(float(new @ new) / readings[-1])
        b.append(float(old @ old) / readings[-1])
        rest = min(a[-1], b[-1]) * readings[-1]
        weight.append(apart / (apart + rest) if apart > 0.0 else 0.0)
    return Told(ids, np.array(a), np.array(b), np.array(weight), np.array(readings, dtype=float))


def ratio(one: Candidate, other: Candidate) -> float:
    """Held-out rms of one model over another's, over the trials that tell them apart; infinite where not tried."""
    found = told(one, other)
    return np.inf if found is None else found.ratio


def agreeing(one: Candidate, other: Candidate) -> float:
    """Share of what unseen trials say of two models that speaks for the one."""
    found = told(one, other)
    if found is None or not found.weight.any():
        return 0.0
    return float(found.weight @ (found.one < found.other) / found.weight.sum())


def choice(tested: Sequence[Candidate], baseline: Candidate, trials: Sequence[TrialData]) -> Candidate:
    """The simplest that predicts as well as the best does, as far as a further parameter is worth naming."""
    good = [c for c in tested if pays(c, baseline, trials)]
    if not good:
        return baseline
    best = min(good, key=lambda c: c.error)
    near = [c for c in good if as_good(c, best, baseline)]
    simplest = min(c.size for c in near)
    first = min((c for c in near if c.size == simplest), key=lambda c: c.error)
    same = [c for c in near if c.size == simplest and ratio(c, first) <= 1.0 + SAME]
    return min(same, key=lambda c: (sum(s.effect.kind == "sensor" for s in c.sites), len(c.sites), c.error))


def pays(new: Candidate, old: Candidate, trials: Sequence[TrialData]) -> bool:
    """Whether unseen trials are predicted better, by enough and throughout."""
    found = told(new, old)
    if found is None or not found.ratio < 1.0 - WORTH_OF_REST:
        return False
    gain, weight = _by_group(found, {t.id: parent(t) for t in trials})
    count = weight.sum()  # of trials as clear as the clearest
    if count < 3.0:
        return bool((gain[weight >= SPOKEN] > 0.0).all())
    mean = weight @ gain / count
    return bool(mean > stdtrit(count - 1.0, SURE) * np.sqrt(weight @ (gain - mean) ** 2 / count / (count - 1.0)))


def _by_group(found: Told, parents: Mapping[str, str]) -> tuple[np.ndarray, np.ndarray]:
    """Gains, as logarithms of mean squares, and what each is based on, 1 at most; by recorded trial, or by piece."""
    by_parent = len(set(parents.values())) > 3
    group = np.unique([parents[i] if by_parent else i for i in found.ids], return_inverse=True)[1].ravel()
    gains = np.log(np.maximum(found.other, 1e-300) / np.maximum(found.one, 1e-300))
    weight = np.bincount(group, found.weight) / np.bincount(group)
    gain = np.bincount(group, found.weight * gains) / np.maximum(np.bincount(group, found.weight), 1e-300)
    return gain, weight / max(float(weight.max()), 1e-300)


def as_good(one: Candidate, best: Candidate, baseline: Candidate) -> bool:
    """Whether a model predicts as well as the best one, so that a further parameter would not be worth naming."""
    if one is best:
        return True
    found, believed = told(one, best), told(baseline, best)
    if found is None or believed is None:
        return False
    return found.rms(found.one) <= slack(found.rms(found.other), found.rms(believed.one))


def slack(best: float, baseline: float) -> float:
    """The largest held-out rms of a model that is as good as the best one."""
    return max(best / (1.0 - WORTH_OF_REST), best + WORTH_OF_BASELINE * baseline)


def distinct(layer: Sequence[Candidate]) -> list[Candidate]:
    """Without those that say the same as one before them in other words (a preload and a bias of its sensor)."""
    kept: list[Candidate] = []
    for one in layer:
        if all(abs(ratio(one, k) - 1.0) > SAME for k in kept):
            kept.append(one)
    return kept
