"""A penalised B-spline through noisy samples, with the standard errors of its value and rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import eigh
from scipy.sparse import csr_array, diags_array

DEGREE = 4
SAMPLES_A_KNOT = 2.5
MOST_KNOTS = 250
CAUTION = 1.4
"""Each degree of freedom counts this much in the cross-validation (Kim and Gu 2004, J. R. Stat. Soc. B 66, Sec. 3)."""

BEYOND = 4.0
"""A value counts as different from zero beyond this many standard errors."""


@dataclass(frozen=True, eq=False)
class Smooth:
    """A smoothed signal. K coefficients.

    Attributes:
        knots: of the spline.
        coefficients: shape (K,).
        root: square root of the coefficients' covariance, shape (K, K).
    """

    knots: np.ndarray
    coefficients: np.ndarray
    root: np.ndarray

    @classmethod
    def through(cls, time: np.ndarray, value: np.ndarray, sigma: np.ndarray) -> Smooth:
        """The spline whose roughness (third differences) the data choose by generalised cross-validation.

        Eilers and Marx (1996), Statist. Sci. 11, Eqs. 12 and 27.

        Args:
            time: ascending, shape (T,) [s].
            value: shape (T,).
            sigma: standard deviations of the noise, shape (T,); used for weights and standard errors.
        """
        n = time.size
        pieces = int(np.clip(n / SAMPLES_A_KNOT, 1, MOST_KNOTS))
        span = max(float(time[-1] - time[0]), 1e-9)
        step = span / pieces
        knots = time[0] + step * np.arange(-DEGREE, pieces + DEGREE + 1)
        basis = _basis(time, knots, 0) / sigma[:, None]
        target = value / sigma
        gram = np.asarray((basis.T @ basis).todense())
        gram += 1e-9 * np.trace(gram) / gram.shape[0] * np.eye(gram.shape[0])
        right = np.asarray(basis.T @ target)
        rough = np.diff(np.eye(gram.shape[0]), n=min(3, gram.shape[0] - 1), axis=0)
        weight, vectors = eigh(rough.T @ rough, gram)  # vectors' gram = identity
        weight = np.maximum(weight, 0.0)
        along = vectors.T @ right
        total = float(target @ target)
        best, found = np.inf, 0.0
        for penalty in np.logspace(-6.0, 14.0, 61) / max(float(weight[-1]), 1e-300) * 1e-2:
            shrink = 1.0 / (1.0 + penalty * weight)
            left = total - 2.0 * float(along**2 @ shrink) + float((along * shrink) @ (along * shrink))
            freedom = n - CAUTION * float(shrink.sum())
            if freedom <= 0.5:
                continue
            score = max(left, 0.0) * n / freedom**2
            if score < best:
                best, found = score, penalty
        shrink = 1.0 / (1.0 + found * weight)
        # sqrt(shrink), not shrink: the Bayesian error covers the bias of the smoothing too (Wahba 1983)
        return cls(knots, vectors @ (shrink * along), vectors * np.sqrt(shrink))

    def value(self, times: np.ndarray, order: int = 0) -> np.ndarray:
        """Signal or derivative at ascending times, shape (len(times),); the ends are held."""
        return np.asarray(_basis(times, self.knots, order) @ self.coefficients)

    def error(self, times: np.ndarray, order: int = 0) -> np.ndarray:
        """Standard error of the same, shape (len(times),)."""
        return np.asarray(np.sqrt(np.square(_basis(times, self.knots, order) @ self.root).sum(axis=1)))


LEAST_SAMPLES = 8


@dataclass(frozen=True, eq=False)
class Pieces:
    """Smooth signals one after another, each as rough as its own stretch of time asks for.

    Attributes:
        cuts: where one ends and the next begins, shape (n - 1,) [s].
        parts: n of them.
    """

    cuts: np.ndarray
    parts: tuple[Smooth, ...]

    @classmethod
    def through(cls, time: np.ndarray, value: np.ndarray, sigma: np.ndarray, cuts: Sequence[float]) -> Pieces:
        """As `Smooth.through` between the cuts [s]; a stretch with too few samples joins the one before."""
        edges = [0]
        for cut in cuts:
            at = int(np.searchsorted(time, cut))
            if at - edges[-1] >= LEAST_SAMPLES and time.size - at >= LEAST_SAMPLES:
                edges.append(at)
        edges.append(time.size)
        parts = tuple(Smooth.through(time[a:b], value[a:b], sigma[a:b]) for a, b in pairwise(edges))
        return cls(np.array([0.5 * (time[e - 1] + time[e]) for e in edges[1:-1]]), parts)

    def value(self, times: np.ndarray, order: int = 0) -> np.ndarray:
        """Signal or derivative at ascending times, shape (len(times),)."""
        return self._joined([p.value(t, order) for p, t in self._split(times)])

    def error(self, times: np.ndarray, order: int = 0) -> np.ndarray:
        """Standard error of the same, shape (len(times),)."""
        return self._joined([p.error(t, order) for p, t in self._split(times)])

    def _split(self, times: np.ndarray) -> list[tuple[Smooth, np.ndarray]]:
        return list(zip(self.parts, np.split(times, np.searchsorted(times, self.cuts)), strict=True))

    @staticmethod
    def _joined(parts: list[np.ndarray]) -> np.ndarray:
        return np.concatenate(parts)


def _basis(times: np.ndarray, knots: np.ndarray, order: int) -> csr_array:
    if times.size == 0:
        return csr_array((0, knots.size - DEGREE - 1))
    inside = np.clip(times, knots[DEGREE], knots[-DEGREE - 1])
    degree = DEGREE - order
    count = knots.size - DEGREE - 1
    kept = knots[order : knots.size - order]
    basis = BSpline.design_matrix(inside, kept, degree)
    out = csr_array(basis)
    step = float(knots[1] - knots[0])
    for k in range(order, 0, -1):  # coefficients of the derivative are differences of the coefficients
        rows = count - k
        both = [np.full(rows, -1.0 / step).tolist(), np.full(rows, 1.0 / step).tolist()]
        out = csr_array(out @ diags_array(both, offsets=[0, 1], shape=(rows, rows + 1)))
    return csr_array(out)
