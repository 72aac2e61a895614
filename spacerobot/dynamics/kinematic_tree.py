"""A robot's moving tree as plain arrays, for compiled code that visits a million poses."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from spacerobot.dynamics.joint_kinds import joint_axis, z_onto
from spacerobot.dynamics.regime import Regime, partition_of
from spacerobot.model.robot import Robot


class KinematicTree(NamedTuple):
    """One-degree-of-freedom joints in topological order (a parent before its children); SI.

    Every joint frame is turned so that its z axis is the joint's axis.

    Attributes:
        parent: shape (m,), index of the parent joint, -1 for the base.
        turning: shape (m,), True for revolute joints, False for prismatic ones.
        rotation: shape (m, 3, 3), joint frame in the parent's at zero.
        translation: shape (m, 3), likewise.
        mass: shape (m,), of the body behind the joint, everything fused to it included.
        center: shape (m, 3), its centre of mass in the joint frame.
        inertia: shape (m, 3, 3), about that centre, joint frame.
        armature: shape (m,), reflected rotor inertia.
        column: shape (m,), index among the moving coordinates (after the base's six), -1 where locked.
        source: shape (m,), which chain position drives the joint, -1 for the slider.
        tip_joint: index of the joint that carries the frame, -1 for the base.
        tip_offset: shape (3,), the frame's origin in that joint's frame.
        on_path: shape (m,), whether the joint moves the frame.
        base_mass: of a floating base [kg].
        base_center: shape (3,).
        base_inertia: shape (3, 3), about that centre.
        floating: whether the base is free.
    """

    parent: np.ndarray
    turning: np.ndarray
    rotation: np.ndarray
    translation: np.ndarray
    mass: np.ndarray
    center: np.ndarray
    inertia: np.ndarray
    armature: np.ndarray
    column: np.ndarray
    source: np.ndarray
    tip_joint: int
    tip_offset: np.ndarray
    on_path: np.ndarray
    base_mass: float
    base_center: np.ndarray
    base_inertia: np.ndarray
    floating: bool


def kinematic_tree(
    robot: Robot, regime: Regime, frame: str | None = None, others: dict[str, float] | None = None
) -> KinematicTree:
    """Pack a robot; joints outside chain and slider are fused at `others` (neutral where absent).

    Args:
        robot: the robot; a floating base stands at the world origin.
        regime: what may move. Locked chain joints stay in the tree, since they differ from pose to pose.
        frame: frame name; the wrist mount if None.
        others: positions of further joints by name.

    Raises:
        NotFoundError: no such frame or joint.
        InputError: a chain joint that is neither revolute nor prismatic.
    """
    wanted = robot.model.frames[robot.frame_id(frame or robot.tip)]
    part = partition_of(robot)
    floats = regime.base == "free"
    moving = {*part.arm.tolist(), *part.slider.tolist(), *(part.base.tolist() if floats else [])}
    fused = [j for j in range(1, robot.model.njoints) if robot.model.joints[j].idx_v not in moving]
    model = pin.buildReducedModel(robot.model, fused, robot.configuration(others=others))
    first = 2 if floats else 1
    rows = range(first, model.njoints)
    order = {name: i for i, name in enumerate(robot.chain)}
    names = [str(model.names[j]) for j in rows]
    kinds = [joint_axis(model, j) for j in rows]
    moves = [regime.joints != "locked" if name in order else regime.slider == "free" for name in names]
    start = 6 if floats else 0
    column = np.where(moves, start + np.cumsum(moves) - 1, -1)
    kind = pin.FrameType.FIXED_JOINT if not model.existFrame(wanted.name, wanted.type) else wanted.type
    tip = model.frames[model.getFrameId(wanted.name, kind)]
    parents = np.array([model.parents[j] - first for j in rows], dtype=np.int64)
    on_path = np.zeros(len(names), dtype=bool)
    joint = tip.parentJoint - first
    while joint >= 0:
        on_path[joint] = True
        joint = parents[joint]
    turned = [pin.SE3(z_onto(axis), np.zeros(3)) for _, axis in kinds]
    before = [turned[p] if p >= 0 else pin.SE3.Identity() for p in parents]
    placements = [b.inverse() * model.jointPlacements[j] * t for b, j, t in zip(before, rows, turned, strict=True)]
    bodies = [t.actInv(model.inertias[j]) for t, j in zip(turned, rows, strict=True)]
    offset = np.array(tip.placement.translation)
    if tip.parentJoint >= first:
        offset = turned[tip.parentJoint - first].rotation.T @ offset
    base = model.inertias[1] if floats else pin.Inertia.Zero()
    return KinematicTree(
        parent=np.maximum(parents, -1),
        turning=np.array([turns for turns, _ in kinds], dtype=bool),
        rotation=_stack([placement.rotation for placement in placements], (3, 3)),
        translation=_stack([placement.translation for placement in placements], (3,)),
        mass=np.array([body.mass for body in bodies], dtype=float),
        center=_stack([body.lever for body in bodies], (3,)),
        inertia=_stack([body.inertia for body in bodies], (3, 3)),
        armature=np.array([model.armature[model.joints[j].idx_v] for j in rows], dtype=float),
        column=column.astype(np.int64),
        source=np.array([order.get(name, -1) for name in names], dtype=np.int64),
        tip_joint=max(tip.parentJoint - first, -1),
        tip_offset=offset,
        on_path=on_path,
        base_mass=float(base.mass),
        base_center=np.array(base.lever),
        base_inertia=np.array(base.inertia),
        floating=floats,
    )


def _stack(arrays: list[np.ndarray], shape: tuple[int, ...]) -> np.ndarray:
    return np.ascontiguousarray(np.array(arrays, dtype=float).reshape(len(arrays), *shape))
