"""The wrist's spring as a coil that is as long as the wrist leaves it room."""

from __future__ import annotations

import numpy as np

from spacerobot.model.build import CONTACT, MOUNT
from spacerobot.model.reading import parse
from spacerobot.model.robot import Robot
from spacerobot.view.scene3d.film import Array, Body, Look, Piece
from spacerobot.view.scene3d.robot_body import frame_poses
from spacerobot.view.scene3d.solids import coil

DRAWN_BY = "wrist_spring"
"""Material of the rings that a wrist's URDF draws for a spring; hidden where the coil is drawn."""

LEAST = 0.004
"""A coil is never drawn shorter [m]."""

_BRASS = Look((0.86, 0.6, 0.2), metal=0.75, rough=0.3)


def wrist_spring(robot: Robot, configurations: Array, *, prefix: str = "robot") -> tuple[Body, ...]:
    """The coil between housing and tip along a motion, (T, nq); nothing for a robot without a wrist of ours."""
    if robot.slider is None or robot.contact != CONTACT or not robot.model.existFrame(MOUNT):
        return ()
    radius = _tip_radius(robot)
    mount, tip = (frame_poses(robot, configurations, frame) for frame in (MOUNT, str(robot.contact)))
    gap = np.linalg.norm(tip[:, :3] - mount[:, :3], axis=1)
    model = robot.model
    rest = float(np.linalg.norm(model.frames[robot.frame_id(str(robot.contact))].placement.translation))
    housing, end = 0.4 * rest, 2.0 * radius
    length = np.maximum(gap - housing - end, LEAST)
    axis = (tip[:, :3] - mount[:, :3]) / np.maximum(gap, 1e-9)[:, None]
    poses = mount.copy()
    poses[:, :3] += housing * axis
    natural = max(rest - housing - end, 2.0 * LEAST)
    solid = coil(1.25 * radius, 0.15 * radius, 7, natural)
    return (Body(f"{prefix}/spring", (Piece(solid, _BRASS),), poses, stretch=length),)


def _tip_radius(robot: Robot) -> float:
    for sphere in parse(robot.urdf, robot.name).iterfind("link/visual/geometry/sphere"):
        material = sphere.getparent().getparent().find("material")
        if material is not None and material.get("name") == "wrist_tip":
            return float(sphere.get("radius") or 0.015)
    return 0.015
