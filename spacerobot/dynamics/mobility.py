"""Mobility: the velocity jump of a frame per unit impulse on it, by three routes that share as little as can
be.

The mobility matrix is G = J H^-1 J^T, shape (6, 6): linear first, world axes, units 1/kg, 1/(kg m), 1/(kg
m^2). The effective mass along a unit direction n is 1/(n^T G_v n) with the linear block G_v (Khatib, IJRR
1995). Masses become infinite at singular poses, mobilities do not, so mobilities are what is compared and
summed.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from spacerobot.dynamics.inertia import cholesky
from spacerobot.dynamics.regime import Regime, partition_of
from spacerobot.dynamics.split import split_mobility
from spacerobot.dynamics.terms import Terms, checked_configuration
from spacerobot.model.robot import Robot

SINGULAR = 1e-10
"""A mobility below this part of the largest one at the same pose is zero, and its effective mass infinite."""


def by_inverse(terms: Terms) -> np.ndarray:
    """J H^-1 J^T through one Cholesky factor; shape (6, 6)."""
    if not len(terms.columns):
        return np.zeros((6, 6))
    rows = np.linalg.solve(cholesky(terms.inertia), terms.jacobian.T)
    return rows.T @ rows


def by_split(terms: Terms) -> np.ndarray:
    """Sum of the parts of slider, base and arm; shape (6, 6)."""
    split = split_mobility(terms)
    return split.slider + split.base + split.arm


def by_forward_dynamics(
    robot: Robot,
    configuration: np.ndarray,
    direction: np.ndarray,
    regime: Regime,
    frame: str | None = None,
) -> float:
    """n^T G_v n as the acceleration along n under a unit force along n, by one articulated-body run.

    Neither H nor J is formed: the force acts on the tip's body as an external wrench, locked joints are
    removed from the model, and the acceleration is read off the frame.

    Args:
        robot: the robot.
        configuration: shape (nq,).
        direction: shape (3,), unit vector in world axes.
        regime: what may move; servo joints count as free.
        frame: frame name; the wrist mount if None.

    Returns:
        mobility [1/kg].
    """
    configuration = checked_configuration(robot, configuration)
    wanted = robot.model.frames[robot.frame_id(frame or robot.tip)]
    model, q = moving_model(robot, configuration, regime)
    if model.nv == 0:
        return 0.0
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    fused = not model.existFrame(wanted.name, wanted.type)  # the frame of a joint that was locked
    frame_id = model.getFrameId(wanted.name, pin.FrameType.FIXED_JOINT if fused else wanted.type)
    body = model.frames[frame_id].parentJoint
    placement = pin.updateFramePlacement(model, data, frame_id)
    force = pin.Force(np.asarray(direction, dtype=float), np.zeros(3))
    at_tip = pin.SE3(np.eye(3), placement.translation).act(force)  # about the world origin
    forces = [pin.Force.Zero() for _ in range(model.njoints)]
    forces[body] = data.oMi[body].actInv(at_tip)
    rest = np.zeros(model.nv)
    acceleration = pin.aba(model, data, q, rest, rest, forces)
    pin.forwardKinematics(model, data, q, rest, acceleration)
    tip = pin.getFrameAcceleration(model, data, frame_id, pin.LOCAL_WORLD_ALIGNED)
    return float(np.dot(tip.linear, direction))


def moving_model(robot: Robot, configuration: np.ndarray, regime: Regime) -> tuple[pin.Model, np.ndarray]:
    """The robot with every joint fused that may not move, without gravity, and its configuration."""
    part = partition_of(robot)
    moving: set[int] = set()
    if regime.base == "free":
        moving.update(part.base.tolist())
    if regime.joints != "locked":
        moving.update(part.arm.tolist())
    if regime.slider == "free":
        moving.update(part.slider.tolist())
    joints = range(1, robot.model.njoints)
    fused = [j for j in joints if robot.model.joints[j].idx_v not in moving]
    model = pin.buildReducedModel(robot.model, fused, configuration)
    model.gravity = pin.Motion.Zero()
    kept = [
        configuration[jm.idx_q : jm.idx_q + jm.nq] for jm in (robot.model.joints[j] for j in joints if j not in fused)
    ]
    return model, np.concatenate(kept) if kept else np.zeros(0)
