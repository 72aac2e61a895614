"""Poses outside the joints' limits are answered, with a warning."""

from __future__ import annotations

import math

import numpy as np

from spacerobot.dynamics.joint_kinds import joint_axis
from spacerobot.model.robot import Robot


class PoseLimitWarning(UserWarning):
    """A joint stands outside the limits of the URDF."""


def pose_limit_warnings(robot: Robot, configuration: np.ndarray) -> tuple[str, ...]:
    """One sentence for every joint outside its limits.

    Args:
        robot: the robot.
        configuration: shape (nq,).
    """
    model = robot.model
    found = []
    for index in range(1, model.njoints):
        joint = model.joints[index]
        if joint.nq != 1:
            continue
        value = float(configuration[joint.idx_q])
        low, high = float(model.lowerPositionLimit[joint.idx_q]), float(model.upperPositionLimit[joint.idx_q])
        slack = 1e-9 * max(1.0, abs(low), abs(high))
        if low < high and not low - slack <= value <= high + slack:
            turns = joint_axis(model, index)[0]
            scale, unit = (180.0 / math.pi, "deg") if turns else (1.0, "m")
            found.append(
                f"joint {model.names[index]} at {value * scale:g} {unit} is outside its limits "
                f"{low * scale:g} to {high * scale:g} {unit}"
            )
    return tuple(found)
