"""Poses from positions, rotations and quaternions; rows (x, y, z, qx, qy, qz, qw)."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from spacerobot.view.scene3d.film import Array


def pose(place: Array, turn: Array) -> Array:
    """One pose, (7,), of a position (3,) and a rotation matrix (3, 3)."""
    found: Array = pin.SE3ToXYZQUAT(pin.SE3(np.ascontiguousarray(turn), np.ascontiguousarray(place)))
    return found


def poses_of(places: Array, turns: Array) -> Array:
    """(T, 7) of positions (T, 3) and rotation matrices (T, 3, 3)."""
    return np.array([pose(place, turn) for place, turn in zip(places, turns, strict=True)])


def turned_about(axis: Array, angles: Array, before: Array) -> Array:
    """Rotations (T, 3, 3): `before` (3, 3) turned about a world axis (3,) by angles (T,) [rad]."""
    return np.array([pin.exp3(np.ascontiguousarray(axis * angle)) @ before for angle in angles])


def shifted(poses: Array, offsets: Array) -> Array:
    """Poses moved by world offsets (T, 3)."""
    out = np.broadcast_to(poses, (len(offsets), 7)).copy()
    out[:, :3] += offsets
    return out
