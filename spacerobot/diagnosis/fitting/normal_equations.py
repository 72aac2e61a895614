"""Normal equations of a fit, its trials' own initial values eliminated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

LEAST = 1.0
"""Curvature of a trial's own value, in units of its scale, that is damped at least: where a joint sticks, how fast it
drifted before shows in nothing, and a step along that would be as long as one likes."""

FURTHEST = 20.0
"""Units of a parameter's scale that a step goes at most; of what stands further off already, as far as it stands: a
stop's stiffness may be a thousand times what is typical, and would take as many steps of one length."""


@dataclass(frozen=True, eq=False)
class Normal:
    """Normal equations with the trials' own parameters eliminated (a Schur complement)."""

    reduced: np.ndarray  # (G, G)
    gradient: np.ndarray  # (G,)
    own: list[tuple[np.ndarray, np.ndarray, np.ndarray]]  # per trial (N, N), (N, G), (N,)
    full: np.ndarray  # (G, G) not reduced
    right: np.ndarray  # (G,) not reduced

    @classmethod
    def build(
        cls, jacobians: Sequence[np.ndarray], residuals: Sequence[np.ndarray], z: np.ndarray, prior: np.ndarray
    ) -> Normal:
        """From the trials' Jacobians, shape (S, G + N) each, residuals, and the prior's precision, shape (G, G)."""
        squares = [jacobian.T @ jacobian for jacobian in jacobians]
        return cls.of_sums(squares, [j.T @ r for j, r in zip(jacobians, residuals, strict=True)], z, prior)

    @classmethod
    def of_sums(
        cls, squares: Sequence[np.ndarray], rights: Sequence[np.ndarray], z: np.ndarray, prior: np.ndarray
    ) -> Normal:
        """From the trials' J'J, shape (G + N, G + N) each, and J'r, shape (G + N,)."""
        count = z.size
        full = prior.astype(float)
        right = prior @ z
        own = []
        for a, b in zip(squares, rights, strict=True):
            full += a[:count, :count]
            right = right + b[:count]
            own.append((a[count:, count:] + 1e-9 * np.eye(a.shape[0] - count), a[count:, :count], b[count:]))
        return cls(*_reduced(full, right, own), own, full, right)

    def covariance(self) -> np.ndarray:
        """Covariance of the global parameters, shape (G, G)."""
        return np.linalg.pinv(self.reduced, hermitian=True)

    def step(
        self,
        damping: float,
        z: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        *,
        far: bool = True,
        own_too: bool = False,
    ) -> tuple[np.ndarray, list[np.ndarray], float]:
        """Damped step within bounds: global part, own parts (in scales), and the promised fall of the cost.

        Args:
            damping: in units of the curvature.
            z: where it begins.
            low: bounds of z.
            high: bounds of z.
            far: whether it may go as far as z stands.
            own_too: whether what trials have of their own is damped as well.
        """
        own, reduced, gradient = self.own, self.reduced, self.gradient
        if own_too:
            own = [(i + damping * np.diag(np.maximum(np.diag(i), LEAST)), cross, tail) for i, cross, tail in own]
            reduced, gradient = _reduced(self.full, self.right, own)
        dz = _within(reduced + damping * np.diag(np.maximum(np.diag(reduced), 1e-8)), gradient, low - z, high - z)
        dz /= max(1.0, float((np.abs(dz) / np.maximum(FURTHEST, np.abs(z) if far else 0.0)).max(initial=0.0)))
        dn = [-np.linalg.solve(inner, tail + cross @ dz) for inner, cross, tail in own]
        promised = -(2.0 * self.right @ dz + dz @ self.full @ dz)
        for (inner, cross, tail), n in zip(self.own, dn, strict=True):
            promised -= float(2.0 * tail @ n + n @ inner @ n + 2.0 * n @ cross @ dz)
        return dz, dn, float(promised)


def _within(a: np.ndarray, gradient: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """The least of x a x / 2 + gradient x within bounds about zero, shape (G,).

    A step that is cut off at a bound is none that pays: what goes with the component that was cut must be found anew.
    """
    x = -np.linalg.lstsq(a, gradient, rcond=1e-13)[0]
    if np.all((x >= low) & (x <= high)):
        return np.asarray(x)
    from scipy.optimize import lsq_linear  # takes a tenth of a second to load

    x, movable = np.zeros_like(gradient), high > low
    values, vectors = np.linalg.eigh(a[np.ix_(movable, movable)])
    roots = np.sqrt(np.maximum(values, 1e-13 * values.max(initial=0.0)))
    goal = -(vectors.T @ gradient[movable]) / np.maximum(roots, 1e-300)
    x[movable] = lsq_linear(roots[:, None] * vectors.T, goal, (low[movable], high[movable]), method="bvls").x
    return x


def _reduced(
    full: np.ndarray, right: np.ndarray, own: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]]
) -> tuple[np.ndarray, np.ndarray]:
    """Matrix and gradient of the global parameters, the trials' own at their best for each."""
    schur, gradient = full.copy(), right.copy()
    for inner, cross, tail in own:
        solved = np.linalg.solve(inner, np.column_stack([cross, tail]))
        schur -= cross.T @ solved[:, :-1]
        gradient -= cross.T @ solved[:, -1]
    return schur, gradient
