"""Bones for robots that draw nothing of themselves: from joint to joint, with hinges, as large as the robot is."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from spacerobot.model.robot import Robot
from spacerobot.view.scene3d.film import Array, Look, Piece
from spacerobot.view.scene3d.solids import Solid, box, capsule, cylinder, sphere

_BONES = Look((0.62, 0.68, 0.76), metal=0.3, rough=0.4)
_HINGES = Look((0.9, 0.5, 0.12), metal=0.3, rough=0.4)


def skeleton(robot: Robot) -> dict[int, list[Piece]]:
    """Joint index -> pieces in the joint's axes; 0 is the world, or what the robot stands on."""
    model = robot.model
    ends: dict[int, list[Array]] = {j: [] for j in range(model.njoints)}
    for joint in range(1, model.njoints):
        ends[model.parents[joint]].append(np.array(model.jointPlacements[joint].translation))
    for name in {robot.tip, robot.contact} - {None}:
        frame = model.frames[robot.frame_id(str(name))]
        ends[frame.parentJoint].append(np.array(frame.placement.translation))
    lengths = [float(np.linalg.norm(end)) for found in ends.values() for end in found]
    levers = [float(np.linalg.norm(model.inertias[j].lever)) for j in range(1, model.njoints)]
    size = max(max(lengths + levers, default=0.0), 0.2)
    pieces: dict[int, list[Piece]] = {j: [] for j in range(model.njoints)}
    if not robot.floating:
        pieces[0].append(Piece(cylinder(0.22 * size, 0.05 * size), _HINGES))
    for joint, found in pieces.items():
        if joint == 1 and robot.floating:
            found.append(Piece(_platform(model.inertias[1], size), _BONES))
        elif joint:
            found.append(Piece(sphere(0.075 * size), _HINGES))
        for end in ends[joint]:
            length = float(np.linalg.norm(end))
            if length > 1e-6:
                place = np.eye(4)
                place[:3, :3] = _z_onto(end / length)
                place[:3, 3] = end / 2.0
                found.append(Piece(capsule(0.045 * size, length).moved(place), _BONES))
        if joint and not (joint == 1 and robot.floating) and all(np.linalg.norm(end) < 1e-6 for end in ends[joint]):
            found.append(Piece(box((0.3 * size, 0.3 * size, 0.3 * size)), _BONES))
    return pieces


def _platform(inertia: pin.Inertia, size: float) -> Solid:
    """The uniform box that has the base's inertia, within reasonable edges, at its centre of mass."""
    moments, turn = np.linalg.eigh(inertia.inertia)
    squares = 6.0 * (moments.sum() - 2.0 * moments) / max(inertia.mass, 1e-9)
    edges = np.clip(np.sqrt(np.maximum(squares, 0.0)), 0.25 * size, 4.0 * size)
    place = np.eye(4)
    place[:3, :3] = turn if np.linalg.det(turn) > 0.0 else turn * [1.0, 1.0, -1.0]
    place[:3, 3] = inertia.lever
    return box((float(edges[0]), float(edges[1]), float(edges[2]))).moved(place)


def _z_onto(direction: Array) -> Array:
    """Rotation (3, 3) that takes z to a unit vector."""
    turn: Array = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), direction).toRotationMatrix()
    return turn
