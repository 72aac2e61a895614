"""A slider for each joint that one number sets: its range is what the URDF allows."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.dynamics.joint_kinds import joint_axis
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError, NotFoundError

UNBOUNDED = (math.pi, 1.0)
"""Half the range of a joint without limits: half a turn [rad], which is all there is to a turning joint, and 1 m."""


@dataclass(frozen=True)
class JointSlider:
    """One slider.

    Attributes:
        name: of the joint.
        low, high: the URDF's limits [rad or m]; half a turn or a metre either way where it states none.
        turns: whether the joint's position is an angle.
    """

    name: str
    low: float
    high: float
    turns: bool

    def checked(self, value: float) -> float:
        """`value` [rad or m], for it is within the limits.

        Raises:
            InputError: it is not.
        """
        slack = 1e-9 * max(1.0, abs(self.low), abs(self.high))
        if not self.low - slack <= value <= self.high + slack:
            scale, unit = (180.0 / math.pi, "deg") if self.turns else (1.0, "m")
            raise InputError(
                "joint position is outside the slider",
                given=f"{value * scale:g} {unit}",
                valid=f"{self.low * scale:g} to {self.high * scale:g} {unit}",
                where=f"joint {self.name}",
            )
        return min(max(value, self.low), self.high)


def joint_sliders(robot: Robot) -> tuple[JointSlider, ...]:
    """A slider for every joint of the robot that one number sets, base to tip.

    Raises:
        InputError: the robot has no such joint.
    """
    model = robot.model
    found = []
    for index in range(1, model.njoints):
        joint = model.joints[index]
        if joint.nv != 1:
            continue
        turns = joint_axis(model, index)[0]
        low, high = -UNBOUNDED[not turns], UNBOUNDED[not turns]
        if joint.nq == 1:
            bounds = float(model.lowerPositionLimit[joint.idx_q]), float(model.upperPositionLimit[joint.idx_q])
            if bounds[0] < bounds[1] and all(map(math.isfinite, bounds)):
                low, high = bounds
        found.append(JointSlider(str(model.names[index]), low, high, turns))
    if not found:
        raise InputError("no joint to put a slider to", given=robot.name, valid="a robot with joints that move")
    return tuple(found)


def starting(sliders: tuple[JointSlider, ...], given: Mapping[str, float]) -> dict[str, float]:
    """Joint -> position [rad or m] for every slider: as given, else neutral or the limit nearest to it.

    Raises:
        InputError: not within the limits, or no such joint.
    """
    unknown = set(given) - {s.name for s in sliders}
    if unknown:
        raise NotFoundError("joint", sorted(unknown)[0], [s.name for s in sliders])
    return {s.name: s.checked(given[s.name]) if s.name in given else min(max(0.0, s.low), s.high) for s in sliders}


def positions_of(robot: Robot, configuration: np.ndarray) -> dict[str, float]:
    """Joint -> position [rad or m] of all joints with a slider, out of a whole configuration, shape (nq,)."""
    found = {}
    for slider in joint_sliders(robot):
        joint = robot.model.joints[robot.joint_id(slider.name)]
        if joint.nq == 2:  # cosine and sine
            found[slider.name] = math.atan2(configuration[joint.idx_q + 1], configuration[joint.idx_q])
        else:
            found[slider.name] = float(configuration[joint.idx_q])
    return found
