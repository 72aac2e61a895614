"""Joint servos as springs and dampers about the pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.dynamics.terms import Terms
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError


@dataclass(frozen=True, eq=False)
class Servo:
    """Stiffness and damping of each chain joint.

    Attributes:
        stiffness: shape (n,), [N m/rad] or [N/m], not negative.
        damping: shape (n,), [N m s/rad] or [N s/m], not negative.
    """

    stiffness: np.ndarray
    damping: np.ndarray

    def impedance(self, terms: Terms) -> tuple[np.ndarray, np.ndarray]:
        """K = blkdiag(0_6, K_p) and D alike as diagonals over the moving coordinates, shape (n,) each."""
        stiffness, damping = np.zeros(len(terms.columns)), np.zeros(len(terms.columns))
        stiffness[terms.arm], damping[terms.arm] = self.stiffness, self.damping
        return stiffness, damping


def servo_of(robot: Robot, stiffness: ArrayLike | None, damping: ArrayLike | None = None) -> Servo:
    """One value for all chain joints or one each; no damping if None.

    Raises:
        InputError: missing stiffness, wrong length, negative or not finite.
    """
    if stiffness is None:
        raise InputError(
            "servo joints need a stiffness",
            valid=f"one value, or one for each of {', '.join(robot.chain)} [N m/rad]",
        )
    return Servo(
        _per_joint(robot, stiffness, "servo stiffness"),
        _per_joint(robot, 0.0 if damping is None else damping, "servo damping"),
    )


def _per_joint(robot: Robot, values: ArrayLike, what: str) -> np.ndarray:
    array = np.atleast_1d(np.asarray(values, dtype=float))
    n = len(robot.chain)
    if array.shape not in ((1,), (n,)):
        raise InputError(
            f"{what} has the wrong length",
            given=array.tolist(),
            valid=f"one value, or {n}: {', '.join(robot.chain)}",
        )
    if not np.isfinite(array).all() or (array < 0.0).any():
        raise InputError(f"{what} must be finite and not negative", given=array.tolist())
    return np.broadcast_to(array, (n,)).copy()
