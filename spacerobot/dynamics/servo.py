"""Joint servos as springs and dampers about the pose."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from spacerobot.dynamics.terms import Terms
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError


class HoldsJoints(Protocol):
    """What holds servo joints, as a scene's `Servo` does: one value for all, or one each, base to tip."""

    @property
    def stiffness(self) -> Any:
        """[N m/rad or N/m]."""

    @property
    def damping(self) -> Any:
        """[N m s/rad or N s/m]."""


@dataclass(frozen=True, eq=False)
class HeldJoints:
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


def servo_of(robot: Robot, stiffness: ArrayLike | None, damping: ArrayLike | None = None) -> HeldJoints:
    """One value for all chain joints or one each; no damping if None.

    Raises:
        InputError: missing stiffness, wrong length, negative or not finite.
    """
    if stiffness is None:
        raise InputError(
            "servo joints need a stiffness",
            valid=f"one value, or one for each of {', '.join(robot.chain)} [N m/rad]",
        )
    return HeldJoints(
        _per_joint(robot, stiffness, "servo stiffness"),
        _per_joint(robot, 0.0 if damping is None else damping, "servo damping"),
    )


def servo_or_its_numbers(
    robot: Robot, servo: HoldsJoints | None, stiffness: ArrayLike | None, damping: ArrayLike | None
) -> HeldJoints:
    """What holds the joints: `servo`, or the two numbers that said so before there was a word for both.

    Raises:
        InputError: both are given, or values that no servo has.
    """
    if servo is None:
        if stiffness is not None:
            warnings.warn("say servo=Servo(stiffness, damping)", DeprecationWarning, stacklevel=3)
        return servo_of(robot, stiffness, damping)
    if stiffness is not None or damping is not None:
        raise InputError("stiffness and damping are the servo's", valid="servo=Servo(stiffness, damping)")
    return servo_of(robot, servo.stiffness, servo.damping)


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
