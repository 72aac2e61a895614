"""What gravity asks of one joint, the others at neutral."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from spacerobot.dynamics.joint_kinds import joint_axis
from spacerobot.model.robot import Robot


def weight_of(robot: Robot, gravity: Sequence[float], joint: str) -> tuple[float, float]:
    """(a, b): gravity asks a sin q + b cos q of the joint at its angle q, or b wherever it has slid [N m or N].

    The other joints are at neutral.
    """
    model = pin.Model(robot.model)
    model.gravity.linear = np.array(gravity, dtype=float)
    data, index = model.createData(), robot.velocity_index(joint)

    def at(angle: float) -> float:
        return float(pin.computeGeneralizedGravity(model, data, robot.configuration(others={joint: angle}))[index])

    turns = joint_axis(robot.model, robot.joint_id(joint))[0]
    return (at(0.5 * math.pi) if turns else 0.0), at(0.0)
