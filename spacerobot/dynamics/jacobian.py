"""Jacobians of a frame in world axes."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from spacerobot.dynamics.inertia import eliminate, joint_space_inertia
from spacerobot.dynamics.regime import partition_of
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError


def frame_jacobian(robot: Robot, configuration: np.ndarray, frame: str | None = None) -> np.ndarray:
    """Velocity of a frame's origin and its angular velocity, per unit generalised velocity.

    Args:
        robot: the robot.
        configuration: shape (nq,).
        frame: frame name; the wrist mount (or the arm's tip) if None.

    Returns:
        shape (6, nv): linear rows first, world axes.

    Raises:
        NotFoundError: no such frame.
    """
    frame_id = robot.frame_id(frame or robot.tip)
    data = robot.model.createData()
    jacobian = pin.computeFrameJacobian(robot.model, data, configuration, frame_id, pin.LOCAL_WORLD_ALIGNED)
    return np.array(jacobian).reshape(6, robot.model.nv)  # one joint's comes as a vector


def generalized_jacobian(robot: Robot, configuration: np.ndarray, frame: str | None = None) -> np.ndarray:
    """J* = J_m - J_b H_b^-1 H_bm of a floating robot at zero momentum (Umetani and Yoshida, IEEE T-RA 1989).

    Args:
        robot: a floating robot; its wrist slider is locked, its other joints (fingers) too.
        configuration: shape (nq,).
        frame: frame name; the wrist mount if None.

    Returns:
        shape (6, len(chain)): velocity of the frame, world axes, linear first, per unit joint velocity.

    Raises:
        InputError: the base does not float.
    """
    if not robot.floating:
        raise InputError("the generalized Jacobian needs a floating base", given=robot.name)
    part = partition_of(robot)
    keep = np.concatenate([part.base, part.arm])
    inertia = joint_space_inertia(robot, configuration)[np.ix_(keep, keep)]
    jacobian = frame_jacobian(robot, configuration, frame)[:, keep]
    return eliminate(inertia, jacobian, np.arange(6))[1]
