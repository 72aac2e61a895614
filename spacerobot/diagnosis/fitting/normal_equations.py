"""Normal equations of a fit, its trials' own initial values eliminated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear


@dataclass(frozen=True, eq=False)
class Normal:
    """Normal equations with the trials' own parameters eliminated (a Schur complement)."""

    reduced: np.ndarray  # (G, G)
    gradient: np.ndarray  # (G,)
    own: list[tuple[np.ndarray, np.ndarray, np.ndarray]]  # per trial (N, N), (N, G), (N,)
    full: np.ndarray  # (G, G) not reduced

    @classmethod
    def build(
        cls, jacobians: Sequence[np.ndarray], residuals: Sequence[np.ndarray], z: np.ndarray, prior: np.ndarray
    ) -> Normal:
        """From the trials' Jacobians, shape (S, G + N) each, residuals, and the prior's precision, shape (G, G)."""
        count = z.size
        full = prior.astype(float)
        gradient = prior @ z
        schur = full.copy()
        right = gradient.copy()
        own = []
        for jacobian, residual in zip(jacobians, residuals, strict=True):
            a = jacobian.T @ jacobian
            b = jacobian.T @ residual
            inner = a[count:, count:] + 1e-9 * np.eye(a.shape[0] - count)
            cross, tail = a[count:, :count], b[count:]
            solved = np.linalg.solve(inner, np.column_stack([cross, tail]))
            schur += a[:count, :count] - cross.T @ solved[:, :count]
            right = right + b[:count] - cross.T @ solved[:, count]
            full += a[:count, :count]
            own.append((inner, cross, tail))
        return cls(schur, right, own, full)

    def covariance(self) -> np.ndarray:
        """Covariance of the global parameters, shape (G, G)."""
        return np.linalg.pinv(self.reduced, hermitian=True)

    def step(
        self, damping: float, z: np.ndarray, low: np.ndarray, high: np.ndarray
    ) -> tuple[np.ndarray, list[np.ndarray], float]:
        """The best damped step within bounds: global part, own parts (in scales), and the promised fall of the cost.

        The best one, not the free step cut short: cut short, it may promise nothing, and the fit would end beside a
        bound with all other values where they were.
        """
        damped = self.reduced + damping * np.diag(np.maximum(np.diag(self.reduced), 1e-8))
        dz = -np.linalg.lstsq(damped, self.gradient, rcond=1e-13)[0]
        if np.any((z + dz < low) | (z + dz > high)):
            dz = _bounded(damped, self.gradient, low - z, high - z)
        largest = np.abs(dz).max(initial=0.0)
        if largest > 20.0:
            dz *= 20.0 / largest
        dn = [-np.linalg.solve(inner, tail + cross @ dz) for inner, cross, tail in self.own]
        profile = float(sum(t @ np.linalg.solve(i, t) for i, _, t in self.own))
        promised = -(2.0 * self.gradient @ dz + dz @ self.reduced @ dz) + profile
        return dz, dn, float(promised)


def _bounded(matrix: np.ndarray, gradient: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Where d A d + 2 g d is least between bounds (Stark and Parker's bounded-variable least squares), shape (G,)."""
    found: np.ndarray = np.minimum(low, high)
    moves = low < high  # a value that is held has one bound for both
    gradient = (gradient + matrix[:, ~moves] @ found[~moves])[moves]
    values, vectors = np.linalg.eigh(matrix[np.ix_(moves, moves)])
    root = np.sqrt(np.maximum(values, 1e-13 * max(values.max(initial=0.0), 1e-300)))
    bounds = low[moves], high[moves]
    found[moves] = lsq_linear(root[:, None] * vectors.T, -(vectors.T @ gradient) / root, bounds, method="bvls").x
    return found
