"""An arm that is held still may be drawn from its other side, where the target would come through it otherwise.

What is simulated of a held arm is its wrist alone, so where the arm stands behind the wrist is a matter of drawing.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin

from spacerobot.model.robot import Robot
from spacerobot.model.wrist import aim
from spacerobot.view.scene3d.extent import rotation
from spacerobot.view.scene3d.film import Array, Body
from spacerobot.view.scene3d.poses import pose

NOTE = "The arm is held: only its wrist is simulated, and the arm is drawn standing behind it."


def comes_through(robot: Robot, positions: Array, approach: Array) -> bool:
    """Whether a target that moves along `approach` would reach the wrist through the arm's base."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(positions))
    reach = np.array(data.oMf[robot.frame_id(robot.tip)].translation)[:2]
    return bool(abs(approach[2]) < 0.9 and reach @ approach[:2] > 0.05)


def half_turned(robot: Robot, positions: Array, approach: Array) -> tuple[Robot, Array]:
    """The arm with its wrist aimed the other way, and the placement (4, 4) that turns arm and wrist back together.

    The mount stays where it was, and the wrist points against `approach` as before.
    """
    turn = np.diag([-1.0, -1.0, 1.0])
    other = aim(robot, positions, turn.T @ approach)
    data = other.model.createData()
    pin.framesForwardKinematics(other.model, data, other.configuration(positions))
    mount = np.array(data.oMf[other.frame_id(other.tip)].translation)
    place = np.eye(4)
    place[:3, :3] = turn
    place[:3, 3] = mount - turn @ mount
    return other, place


def placed(bodies: tuple[Body, ...], place: Array) -> tuple[Body, ...]:
    """Bodies under a rigid placement (4, 4)."""

    def moved(row: Array) -> Array:
        return pose(place[:3, :3] @ row[:3] + place[:3, 3], place[:3, :3] @ rotation(row[3:]))

    return tuple(replace(body, poses=np.array([moved(row) for row in body.poses])) for body in bodies)
