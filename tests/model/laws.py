"""What several of the model tests compare: joint-space inertia, effective mass, sample arms."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from spacerobot.model.robot import Robot

POSE = np.radians([0.0, 45.0, 0.0, 90.0, 0.0, -45.0, 0.0])

ARMS = ("pa10", "pa10c", "panda", "ur5", "kinova", "xarm7")
"""Arms without a wrist that every assembly function must take."""


def joint_inertia(model: pin.Model, q: np.ndarray) -> np.ndarray:
    """Shape (nv, nv), armature included."""
    upper = np.triu(pin.crba(model, model.createData(), q))
    return upper + np.triu(upper, 1).T


def effective_masses(robot: Robot, q: np.ndarray, frame: str) -> np.ndarray:
    """Shape (3,): 1 / (e_i^T J H^-1 J^T e_i) along x, y, z with all joints free [kg]."""
    jacobian = pin.computeFrameJacobian(
        robot.model, robot.model.createData(), q, robot.frame_id(frame), pin.LOCAL_WORLD_ALIGNED
    )[:3]
    return 1 / np.diag(jacobian @ np.linalg.solve(joint_inertia(robot.model, q), jacobian.T))


def placement(robot: Robot, q: np.ndarray, frame: str) -> pin.SE3:
    """Where a frame is in the world."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.frame_id(frame)].copy()


def random_pose(robot: Robot, seed: int) -> np.ndarray:
    """Shape (len(chain),): within the limits, or within a turn where there are none."""
    rng = np.random.default_rng(seed)
    bounds = []
    for name in robot.chain:
        joint = robot.model.joints[robot.joint_id(name)]
        low, high = (v[joint.idx_q] for v in (robot.model.lowerPositionLimit, robot.model.upperPositionLimit))
        bounds.append((low, high) if joint.nq == 1 and np.isfinite([low, high]).all() else (-np.pi, np.pi))
    return np.array([rng.uniform(max(low, -3), min(high, 3)) for low, high in bounds])
