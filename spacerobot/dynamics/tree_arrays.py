"""Any Pinocchio model as plain arrays, for the compiled recursion in `tree_recursion`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from spacerobot.dynamics.joint_kinds import joint_axis, z_onto
from spacerobot.support.errors import InputError
from spacerobot.support.jit import jit, lean_twin

TURN, SLIDE, CIRCLE, BALL, FREE = range(5)
"""Kinds of joint: one angle; one distance; one angle kept as cosine and sine; a unit quaternion; a place and one."""


class TreeArrays(NamedTuple):
    """Constants of a model of m joints and nv velocities; SI, joint frames as Pinocchio has them.

    Attributes:
        joint: shape (m, 5), int: parent (-1: the world), kind, first index into q and into v, root of its own tree.
        before: shape (m, 12), placement in the parent: rotation by rows, then translation. The z axis of the
            rotation is the joint's own axis, where it has one.
        after: shape (m, 9), rotation from that turned frame back to the joint's, by rows.
        plain: shape (m,), int: whether `after` is the identity.
        mass: shape (m,).
        moment: shape (m, 3), mass times centre of mass, joint frame.
        inertia: shape (m, 6), xx, xy, yy, xz, yz, zz about the joint frame's origin, joint frame.
        armature: shape (nv,).
        gravity: shape (3,) [m/s^2].
    """

    joint: np.ndarray
    before: np.ndarray
    after: np.ndarray
    plain: np.ndarray
    mass: np.ndarray
    moment: np.ndarray
    inertia: np.ndarray
    armature: np.ndarray
    gravity: np.ndarray


class TreeWork(NamedTuple):
    """What one evaluation leaves. World axes; every tree (what hangs on one root joint) about a point of its own.

    Attributes:
        rotation: shape (m, 9), joint frame in the world, by rows.
        place: shape (m, 3), of the joint frame, from its tree's point.
        point: shape (m, 3), that point in the world: where the root joint's frame is, so that a body that has flown
            far away loses no digits.
        motion: shape (nv, 6), columns of the Jacobian: velocity of the body's point at its tree's point, then angular.
        drift: shape (nv, 6), their rate of change in fixed axes about that fixed point.
        speed: shape (m, 6), velocity and angular velocity of every body.
        bias: shape (m, 6), acceleration at zero joint acceleration, without gravity.
        force: shape (m, 6), force and moment that the body asks for; then of everything behind the joint.
        composite: shape (m, 10), mass, moment and inertia of everything behind the joint.
        inertia: shape (nv, nv), joint-space inertia.
        load: shape (nv,), Coriolis, centrifugal and gravity terms.
    """

    rotation: np.ndarray
    place: np.ndarray
    point: np.ndarray
    motion: np.ndarray
    drift: np.ndarray
    speed: np.ndarray
    bias: np.ndarray
    force: np.ndarray
    composite: np.ndarray
    inertia: np.ndarray
    load: np.ndarray


def tree_arrays(model: pin.Model) -> TreeArrays:
    """Pack a model of revolute, prismatic, spherical and free-flyer joints.

    Raises:
        InputError: a joint of another kind.
    """
    rows = range(1, model.njoints)
    joint = np.zeros((len(rows), 5), dtype=np.int64)
    before, after = np.zeros((len(rows), 12)), np.tile(np.eye(3).ravel(), (len(rows), 1))
    plain = np.ones(len(rows), dtype=np.int64)
    mass, moment, inertia = np.zeros(len(rows)), np.zeros((len(rows), 3)), np.zeros((len(rows), 6))
    for i, j in enumerate(rows):
        record, parent = model.joints[j], int(model.parents[j]) - 1
        kind, turned = _kind(model, j)
        root = i if parent < 0 else joint[parent, 4]
        joint[i] = parent, kind, record.idx_q, record.idx_v, root
        placement = model.jointPlacements[j]
        before[i, :9] = (placement.rotation @ turned).ravel()
        before[i, 9:] = placement.translation
        after[i] = turned.T.ravel()
        plain[i] = int(np.array_equal(turned, np.eye(3)))
        body = model.inertias[j]
        mass[i], moment[i] = body.mass, body.mass * body.lever
        about = np.asarray(body.matrix())[3:, 3:]
        inertia[i] = about[0, 0], about[0, 1], about[1, 1], about[0, 2], about[1, 2], about[2, 2]
    return TreeArrays(
        joint, before, after, plain, mass, moment, inertia, np.array(model.armature), np.array(model.gravity.linear)
    )


def _kind(model: pin.Model, joint: int) -> tuple[int, np.ndarray]:
    """The joint's kind, and a rotation whose z axis is its axis (the identity where it has none)."""
    record = model.joints[joint]
    name, size = record.shortname(), (record.nq, record.nv)
    if size == (7, 6) and "FreeFlyer" in name:
        return FREE, np.eye(3)
    if size == (4, 3) and name.endswith("Spherical"):
        return BALL, np.eye(3)
    if record.nv != 1:
        raise InputError(
            "no compiled dynamics for this joint",
            given=f"{model.names[joint]} ({name})",
            valid="revolute, continuous, prismatic, spherical, floating",
        )
    turns, axis = joint_axis(model, joint)
    kind = (TURN if record.nq == 1 else CIRCLE) if turns else SLIDE
    if np.array_equal(axis, [0.0, 0.0, 1.0]):
        return kind, np.eye(3)
    return kind, z_onto(axis)


def packed_tree(tree: TreeArrays) -> tuple[np.ndarray, np.ndarray, int]:
    """Integers and floats that hold a tree, and the size of its work."""
    m, nv = tree.mass.size, tree.armature.size
    ints = np.concatenate([np.array([m, nv]), tree.joint.ravel(), tree.plain]).astype(np.int64)
    floats = [tree.before, tree.after, tree.mass, tree.moment, tree.inertia, tree.armature, tree.gravity]
    return ints, np.concatenate([a.ravel() for a in floats]).astype(float), 43 * m + 13 * nv + nv * nv


@jit
def tree_from(k: Any, x: Any) -> TreeArrays:
    """The tree that `packed_tree` wrote, as views."""
    m, nv = k[0], k[1]
    joint, plain = k[2 : 2 + 5 * m].reshape((m, 5)), k[2 + 5 * m : 2 + 6 * m]
    before, after = x[: 12 * m].reshape((m, 12)), x[12 * m : 21 * m].reshape((m, 9))
    mass, moment = x[21 * m : 22 * m], x[22 * m : 25 * m].reshape((m, 3))
    inertia, a = x[25 * m : 31 * m].reshape((m, 6)), 31 * m
    return TreeArrays(joint, before, after, plain, mass, moment, inertia, x[a : a + nv], x[a + nv : a + nv + 3])


@jit
def tree_work_from(k: Any, s: Any) -> TreeWork:
    """The work of such a tree inside an array, as views."""
    m, nv = k[0], k[1]
    rotation, place = s[: 9 * m].reshape((m, 9)), s[9 * m : 12 * m].reshape((m, 3))
    point, speed = s[12 * m : 15 * m].reshape((m, 3)), s[15 * m : 21 * m].reshape((m, 6))
    bias, force = s[21 * m : 27 * m].reshape((m, 6)), s[27 * m : 33 * m].reshape((m, 6))
    composite, a = s[33 * m : 43 * m].reshape((m, 10)), 43 * m
    motion, drift = s[a : a + 6 * nv].reshape((nv, 6)), s[a + 6 * nv : a + 12 * nv].reshape((nv, 6))
    load, b = s[a + 12 * nv : a + 13 * nv], a + 13 * nv
    inertia = s[b : b + nv * nv].reshape((nv, nv))
    return TreeWork(rotation, place, point, motion, drift, speed, bias, force, composite, inertia, load)


tree_inside, tree_work_inside = lean_twin(tree_from), lean_twin(tree_work_from)
"""The same for compiled callers; what they return must not reach Python."""
