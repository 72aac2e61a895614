"""Where a fit stands, and where it ended."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Hypothesis

UNTOLD = 1e-6
"""Share of what was believed of a value that readings take away, below which they say nothing of it but rounding."""


@dataclass(frozen=True, eq=False)
class TrialFit:
    """Where one trial stands in a fit. S kept samples, N own initial values."""

    initial: np.ndarray  # (N,)
    residual: np.ndarray  # (S,) predicted minus measured, in sensor sigmas, zero where masked


@dataclass(frozen=True, eq=False)
class Fit:
    """A hypothesis at its best parameters.

    Attributes:
        hypothesis: which.
        z: free parameters, shape (G,).
        trials: per trial, by id.
        chi2: sum of squared weighted residuals.
        prior: sum of squares of the parameters with a prior.
        samples: number of samples that count.
        covariance: of z, shape (G, G), initial values marginalised; None before it is known.
        converged: whether the last step was negligible.
        iterations: Gauss-Newton steps taken.
        given_up: whether it ended on what its first step promised.
    """

    hypothesis: Hypothesis
    z: np.ndarray
    trials: Mapping[str, TrialFit]
    chi2: float
    prior: float
    samples: int
    covariance: np.ndarray | None
    converged: bool
    iterations: int
    given_up: bool = False

    @property
    def cost(self) -> float:
        """chi-squared plus prior."""
        return self.chi2 + self.prior

    def values(self) -> dict[str, float]:
        """Physical values of the free parameters."""
        return self.hypothesis.values(self.z)

    def errors(self) -> dict[str, tuple[float, float]]:
        """Physical values one standard error below and above, by key; empty where no covariance is known."""
        if self.covariance is None:
            return {}
        sigma = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        rows = zip(self.hypothesis.free, self.z, sigma, strict=True)
        return {f.key: (f.value(float(z - s)), f.value(float(z + s))) for f, z, s in rows}

    def contradictions(self, z: np.ndarray | None = None) -> dict[str, float]:
        """By believed value, how far the readings are from what is stated, in standard deviations of their difference.

        What is stated draws the fit its way. Where that ends at z, with variance v (both in stated sigmas), readings
        alone would end at z / (1 - v), known to v / (1 - v); the square is by how much the cost falls where nothing is
        stated of it. Values of which the readings know nothing contradict nothing.

        Args:
            z: where the fit ends, shape (G,); its own if None.
        """
        if self.covariance is None:
            return {}
        rows = zip(self.hypothesis.free, self.z if z is None else z, np.diag(self.covariance), strict=True)
        return {
            f.key: float(at) / math.sqrt(1.0 - v)
            for f, at, v in rows
            if f.kind == "believed" and f.key not in self.hypothesis.freed and v < 1.0 - UNTOLD
        }

    def initials(self) -> dict[str, np.ndarray]:
        """Initial values by trial, for a warm start."""
        return {name: t.initial for name, t in self.trials.items()}

    def residuals(self) -> dict[str, np.ndarray]:
        """Weighted residuals by trial, shape (S,) each."""
        return {name: t.residual for name, t in self.trials.items()}


@dataclass(frozen=True, eq=False)
class State:
    """Where a descent stands: parameters, weighted residuals before masking, and which samples count."""

    z: np.ndarray
    own: dict[str, np.ndarray]
    raw: dict[str, np.ndarray]  # (S,) per trial
    keep: dict[str, np.ndarray]  # (S,) bool per trial

    def chi2(self) -> float:
        """Sum of squares of the residuals that count."""
        return float(sum(np.square(r[self.keep[name]]).sum() for name, r in self.raw.items()))

    def groups(self, trial: TrialData, keep: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sum of squares and number of the samples that count, per channel of a trial."""
        squares = np.where(keep, self.raw[trial.id], 0.0) ** 2
        edges = np.concatenate([np.full(len(b.channels), b.time.size) for b in trial.blocks])
        starts = np.concatenate([[0], np.cumsum(edges)[:-1]])
        return np.add.reduceat(squares, starts), np.add.reduceat(keep.astype(float), starts)

    def loss(self, trials: Sequence[TrialData], robust: bool, keep: Mapping[str, np.ndarray] | None = None) -> float:
        """What a descent lowers: chi-squared, or its robust form, here or under another state's masks.

        Robust: a channel of a trial with n samples and sum of squares S > n counts n (1 + ln(S/n)), the profile
        likelihood of a noise level of its own; so what does not fit yet cannot drag what does.
        """
        total = 0.0
        for trial in trials:
            square, count = self.groups(trial, (keep or self.keep)[trial.id])
            if robust:
                ratio = np.maximum(square / np.maximum(count, 1.0), 1.0)
                square = np.where(ratio > 1.0, count * (1.0 + np.log(ratio)), square)
            total += float(square.sum())
        return total

    def weights(self, trial: TrialData) -> np.ndarray:
        """Square roots of the robust weights of a trial's samples, shape (S,)."""
        square, count = self.groups(trial, self.keep[trial.id])
        weight = np.sqrt(1.0 / np.maximum(square / np.maximum(count, 1.0), 1.0))
        return np.repeat(weight, np.concatenate([np.full(len(b.channels), b.time.size) for b in trial.blocks]))

    @property
    def samples(self) -> int:
        """Number of samples that count."""
        return int(sum(k.sum() for k in self.keep.values()))


NORMAL_95 = 1.959963984540054


def interval(fit: Fit, key: str, inflation: float) -> tuple[float, tuple[float, float]]:
    """A free parameter's value and its 95 % interval, initial values and all other parameters marginalised."""
    index = fit.hypothesis.keys.index(key)
    free, z = fit.hypothesis.free[index], float(fit.z[index])
    spread = math.inf
    if fit.covariance is not None:
        spread = NORMAL_95 * math.sqrt(max(float(fit.covariance[index, index]), 0.0) * inflation)
    if not math.isfinite(spread) or spread > 1e6:
        return free.value(z), (free.lower, free.upper)
    return free.value(z), (free.value(z - spread), free.value(z + spread))


Intervals = Mapping[str, tuple[float, float]]
"""95 % intervals found by profile likelihood, by key; those of the curvature at the best fit where one is absent."""
