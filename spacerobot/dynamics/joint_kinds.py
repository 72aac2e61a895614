"""Which joints turn and which slide, and their axes."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pinocchio as pin

from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError


def joint_axis(model: pin.Model, joint: int) -> tuple[bool, np.ndarray]:
    """Whether a one-degree-of-freedom joint turns, and its unit axis in the joint frame, shape (3,).

    Raises:
        InputError: a joint of another kind (helical, spherical, mimic).
    """
    record = model.joints[joint]
    if record.nv == 1:
        data = record.createData()
        record.calc(data, pin.neutral(model))
        subspace = np.asarray(data.S, dtype=float).ravel()
        turning, sliding = np.any(subspace[3:]), np.any(subspace[:3])
        if turning != sliding:
            return bool(turning), subspace[3:] if turning else subspace[:3]
    raise InputError("joint is neither revolute nor prismatic", given=f"{model.names[joint]} ({record.shortname()})")


def z_onto(axis: np.ndarray) -> np.ndarray:
    """A rotation whose third column is `axis`."""
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])


def angular(robot: Robot, names: Iterable[str]) -> list[bool]:
    """Whether each named joint turns (its position is an angle).

    Raises:
        NotFoundError: no such joint.
        InputError: a joint of another kind.
    """
    return [joint_axis(robot.model, robot.joint_id(name))[0] for name in names]
