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
        count = z.size
        full = prior.astype(float)
        right = prior @ z
        own = []
        for jacobian, residual in zip(jacobians, residuals, strict=True):
            a = jacobian.T @ jacobian
            b = jacobian.T @ residual
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
        free = np.ones(z.size, dtype=bool)
        dz = np.zeros(z.size)
        for _ in range(z.size + 1):
            index = np.flatnonzero(free)
            a = reduced[np.ix_(index, index)]
            a = a + damping * np.diag(np.maximum(np.diag(a), 1e-8))
            dz[:] = 0.0
            dz[index] = -np.linalg.lstsq(a, gradient[index], rcond=1e-13)[0]
            out = free & (((z + dz < low) & (z <= low + 1e-12)) | ((z + dz > high) & (z >= high - 1e-12)))
            if not out.any():
                break
            free &= ~out
        dz = np.clip(z + dz, low, high) - z
        dz /= max(1.0, float((np.abs(dz) / np.maximum(FURTHEST, np.abs(z) if far else 0.0)).max(initial=0.0)))
        dn = [-np.linalg.solve(inner, tail + cross @ dz) for inner, cross, tail in own]
        promised = -(2.0 * self.right @ dz + dz @ self.full @ dz)
        for (inner, cross, tail), n in zip(self.own, dn, strict=True):
            promised -= float(2.0 * tail @ n + n @ inner @ n + 2.0 * n @ cross @ dz)
        return dz, dn, float(promised)


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
