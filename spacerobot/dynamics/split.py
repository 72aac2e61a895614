"""The mobility of a frame taken apart: what the slider, the base and the arm each give."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.dynamics.inertia import cholesky, eliminate
from spacerobot.dynamics.terms import Terms


@dataclass(frozen=True, eq=False)
class MobilitySplit:
    """J H^-1 J^T = slider + base + arm, each positive semidefinite; hence joints free <= joints locked in
    mass.

    Attributes:
        slider: shape (6, 6), the wrist slider with everything else held; zero at a frame before the slider.
        base: shape (6, 6), base and arm as one rigid body (joints locked); zero for a fixed base.
        arm: shape (6, 6), J* H*^-1 J*^T with the base free to react.
        jacobian: shape (6, n_arm), J*, the generalized Jacobian; the plain one for a fixed base.
        inertia: shape (n_arm, n_arm), H*.
    """

    slider: np.ndarray
    base: np.ndarray
    arm: np.ndarray
    jacobian: np.ndarray
    inertia: np.ndarray

    @property
    def locked(self) -> np.ndarray:
        """Mobility with the joints locked, shape (6, 6)."""
        return self.slider + self.base

    @property
    def free(self) -> np.ndarray:
        """Mobility with the joints free, shape (6, 6)."""
        return self.slider + self.base + self.arm


def split_mobility(terms: Terms) -> MobilitySplit:
    """Eliminate the slider, then the base; what is left is the arm.

    J H^-1 J^T = J_b H_b^-1 J_b^T + J* H*^-1 J*^T with J* = J_m - J_b H_b^-1 H_bm and H* = H_m - H_bm^T H_b^-1
    H_bm (Umetani and Yoshida, IEEE T-RA 1989), H and J after the slider's Schur complement.

    Args:
        terms: H and J of what moves.
    """
    inertia, jacobian = terms.inertia, terms.jacobian
    slider = base = arm = np.zeros((6, 6))
    if len(terms.slider):
        inertia, jacobian, slider = eliminate(inertia, jacobian, terms.slider)
    if len(terms.base):
        inertia, jacobian, base = eliminate(inertia, jacobian, terms.base)
    if len(terms.arm):
        rows = np.linalg.solve(cholesky(inertia), jacobian.T)
        arm = rows.T @ rows
    return MobilitySplit(slider=slider, base=base, arm=arm, jacobian=jacobian, inertia=inertia)
