"""What a further parameter is worth: which of the models that were tried is chosen, and which predict as well.

Unseen trials decide, by an effect size and by a test; information criteria would keep rewarding arbitrary terms. Two
models are compared over the channels of the trials that tell them apart: where both predict the same, however many
such readings there are, nothing is said for or against either.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import stdtrit

from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import (
    CHANCE,
    EXACT,
    LOUD,
    QUIET,
    REWORDED,
    SPOKEN,
    WORTH_OF_BASELINE,
    WORTH_OF_REST,
)


@dataclass(frozen=True, eq=False)
class Told:
    """What unseen trials say of two models. K channels of trials; several campaigns at once lead all shapes (`...`).

    Attributes:
        one, other: mean squares of their weighted residuals, shape (..., K).
        apart: mean squares of the differences of their predictions, shape (..., K).
        readings: of each, shape (K,).
        trials: whose, K ids.
    """

    one: np.ndarray
    other: np.ndarray
    apart: np.ndarray
    readings: np.ndarray
    trials: tuple[str, ...] = ()

    @cached_property
    def weight(self) -> np.ndarray:
        """How far each tells the two apart, shape (..., K), from 0 to 1: d^2 / (d^2 + s^2).

        d^2 is the mean square of the difference of their predictions and s^2 what the better one leaves over.
        """
        rest = np.minimum(self.one, self.other)
        return np.where(self.apart > 0.0, self.apart / np.where(self.apart > 0.0, self.apart + rest, 1.0), 0.0)

    def rms(self, square: np.ndarray) -> np.ndarray:
        """Root mean square over the readings that tell, of mean squares, (..., K) to (...)."""
        weight = self.weight * self.readings
        return np.asarray(np.sqrt((weight * square).sum(axis=-1) / np.maximum(weight.sum(axis=-1), 1e-300)))

    @property
    def ratio(self) -> np.ndarray:
        """Held-out rms of the one over the other's, shape (...); 1 where nothing tells them apart."""
        one, other = self.rms(self.one), self.rms(self.other)
        return np.where(other > 0.0, one / np.where(other > 0.0, other, 1.0), 1.0)

    def better(self, group: np.ndarray) -> np.ndarray:
        """Whether the one predicts better, by enough and throughout, shape (...); `group` as in `sure`."""
        return np.asarray((self.ratio < 1.0 - WORTH_OF_REST) & self.sure(group))

    def sure(self, group: np.ndarray) -> np.ndarray:
        """Whether the one predicts better throughout, by however little, shape (...).

        Args:
            group: what each belongs to, shape (K,); gains within one are no independent ones.
        """
        gain, weight = self._by_group(group)
        count = np.maximum(weight.sum(axis=-1), 1e-300)  # of groups as clear as the clearest
        every = np.all((gain > 0.0) | (weight < SPOKEN), axis=-1)
        mean = (weight * gain).sum(axis=-1) / count
        freedom = np.maximum(count - 1.0, 1.0)
        scatter = (weight * (gain - mean[..., None]) ** 2).sum(axis=-1)
        sure = mean > stdtrit(freedom, 1.0 - CHANCE) * np.sqrt(scatter / count / freedom)
        return np.asarray(np.where(count < 3.0, every, sure))

    def _by_group(self, group: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gains, as logarithms of mean squares, and what each is based on, 1 at most; shape (..., groups) each."""
        member = (group[:, None] == np.unique(group)).astype(float)
        least = np.maximum(EXACT * self.rms(np.minimum(self.one, self.other)) ** 2, 1e-300)[..., None]
        gains = np.log(np.maximum(self.other, least)) - np.log(np.maximum(self.one, least))
        total = self.weight @ member
        gain = (self.weight * gains) @ member / np.maximum(total, 1e-300)
        weight = total / member.sum(axis=0)
        return gain, weight / np.maximum(weight.max(axis=-1, keepdims=True), 1e-300)


def told(one: Candidate, other: Candidate) -> Told | None:
    """What unseen trials say of two models; None where one of them was not tried."""
    if one.held_out is None or other.held_out is None:
        return None
    rows, trials = [], []
    for name in one.held_out.residual:
        both = zip(one.held_out.pieces(name), other.held_out.pieces(name), strict=True)
        for (a, counted), (b, _) in both:
            n = max(int(counted.sum()), 1)
            rows.append((a @ a / n, b @ b / n, (a - b) @ (a - b) / n, n))
            trials.append(name)
    ours, theirs, apart, readings = np.array(rows, dtype=float).reshape(-1, 4).T
    return Told(ours, theirs, apart, readings, tuple(trials))


def ratio(one: Candidate, other: Candidate) -> float:
    """Held-out rms of one model over another's, over the trials that tell them apart; infinite where not tried."""
    found = told(one, other)
    return np.inf if found is None else float(found.ratio)


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
    same = [c for c in near if c.size == simplest and ratio(c, first) <= 1.0 + REWORDED]
    return min(same, key=lambda c: (sum(s.effect.kind == "sensor" for s in c.sites), len(c.sites), c.error))


def pays(new: Candidate, old: Candidate, trials: Sequence[TrialData]) -> bool:
    """Whether unseen trials are predicted better, by enough and throughout."""
    found = told(new, old)
    return found is not None and bool(found.better(_grouped(found, trials)))


def surely(new: Candidate, old: Candidate, trials: Sequence[TrialData]) -> bool:
    """Whether unseen trials are predicted better throughout, by however little."""
    found = told(new, old)
    return found is not None and bool(found.sure(_grouped(found, trials)))


def _grouped(found: Told, trials: Sequence[TrialData]) -> np.ndarray:
    by = {t.id: t for t in trials}
    return groups([by[name] for name in found.trials])


def groups(trials: Sequence[TrialData]) -> np.ndarray:
    """What each trial belongs to, shape (K,), for gains to be independent: its recorded trial, or itself where few.

    A machine that stands still says what it says once.
    """
    parents = [t.recorded for t in trials]
    return np.array(parents if len(set(parents)) > 3 else [t.told_by for t in trials])


def as_good(one: Candidate, best: Candidate, baseline: Candidate) -> bool:
    """Whether a model predicts as well as the best one, so that a further parameter would not be worth naming.

    However large the baseline's error was, what is louder than the stated noise is not as good as what comes near it:
    friction is no less there because a load outweighs it.
    """
    if one is best:
        return True
    found, believed = told(one, best), told(baseline, best)
    if found is None or believed is None:
        return False
    told_by_noise = one.loud > LOUD and best.loud <= QUIET
    whole = np.zeros(()) if told_by_noise else found.rms(believed.one)
    return bool(found.rms(found.one) <= slack(found.rms(found.other), whole))


def slack(best: np.ndarray, baseline: np.ndarray) -> np.ndarray:
    """The largest held-out rms of a model that is as good as the best one."""
    return np.asarray(np.maximum(best / (1.0 - WORTH_OF_REST), best + WORTH_OF_BASELINE * baseline))


def distinct(layer: Sequence[Candidate]) -> list[Candidate]:
    """Without those that say the same as one before them in other words (a preload and a bias of its sensor)."""
    kept: list[Candidate] = []
    for one in layer:
        if all(abs(ratio(one, k) - 1.0) > REWORDED for k in kept):
            kept.append(one)
    return kept
