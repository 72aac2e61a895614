"""A robot's looks from its URDF: one body for each joint that carries something to see."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import numpy as np
import pinocchio as pin
from lxml import etree

from spacerobot.model.meshes import mesh_path
from spacerobot.model.reading import parse
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from spacerobot.view.scene3d.film import Array, Body, Look, Piece
from spacerobot.view.scene3d.meshfiles import read_mesh
from spacerobot.view.scene3d.skeleton import skeleton
from spacerobot.view.scene3d.solids import Solid, box, capsule, cylinder, sphere

TRIANGLES = 60_000
"""Of a whole robot's meshes, roughly; about 3 MB of page."""

_METAL = {
    "foil": Look(metal=0.95, rough=0.34),
    "steel": Look(metal=0.85, rough=0.3),
    "grey": Look(metal=0.45, rough=0.42),
    "panel": Look(metal=0.55, rough=0.3),
    "dark": Look(metal=0.2, rough=0.55),
    "white": Look(metal=0.05, rough=0.42),
}
"""Words in the names of materials -> how such a surface takes the light; colours come from the URDF."""


def robot_bodies(robot: Robot, configurations: Array, *, prefix: str = "robot", hide: str = "") -> tuple[Body, ...]:
    """Bodies of a robot along a motion.

    Args:
        robot: any; where its URDF draws nothing (or its meshes are missing) bones are drawn from joint to joint.
        configurations: (T, nq).
        prefix: of the bodies' names.
        hide: material whose shapes are left out.
    """
    pieces = _pieces(robot, hide)
    if not any(pieces.values()):
        pieces = skeleton(robot)
    poses = joint_poses(robot, configurations)
    return tuple(
        Body(f"{prefix}/{robot.model.names[joint] if joint else 'base'}", tuple(found), poses[joint])
        for joint, found in sorted(pieces.items())
        if found
    )


def joint_poses(robot: Robot, configurations: Array) -> Array:
    """Poses of all joints along a motion, shape (joints, T, 7)."""
    data = robot.model.createData()
    out = np.zeros((robot.model.njoints, len(configurations), 7))
    for t, q in enumerate(configurations):
        pin.forwardKinematics(robot.model, data, np.ascontiguousarray(q))
        for joint in range(robot.model.njoints):
            out[joint, t] = pin.SE3ToXYZQUAT(data.oMi[joint])
    return out


def frame_poses(robot: Robot, configurations: Array, frame: str) -> Array:
    """Poses of a frame along a motion, shape (T, 7)."""
    data, index = robot.model.createData(), robot.frame_id(frame)
    out = np.zeros((len(configurations), 7))
    for t, q in enumerate(configurations):
        pin.framesForwardKinematics(robot.model, data, np.ascontiguousarray(q))
        out[t] = pin.SE3ToXYZQUAT(data.oMf[index])
    return out


def urdf_pieces(urdf: str, link: str) -> tuple[Piece, ...]:
    """What a URDF draws of one link, in the link's axes; primitives only."""
    root = parse(urdf, "URDF")
    colours = _colours(root)
    element = next(e for e in root.findall("link") if e.get("name") == link)
    return tuple(p for v in element.findall("visual") for p in _visual(v, colours, (), 0))


def _pieces(robot: Robot, hide: str) -> dict[int, list[Piece]]:
    root = parse(robot.urdf, robot.name)
    colours = _colours(root)
    shapes = [(link, list(link.findall("visual"))) for link in root.findall("link")]
    meshes = sum(1 for _, visuals in shapes for v in visuals if v.find("geometry/mesh") is not None)
    budget = TRIANGLES // max(meshes, 1)
    found: dict[int, list[Piece]] = defaultdict(list)
    for link, visuals in shapes:
        name = link.get("name")
        if not robot.model.existFrame(name):
            continue
        frame = robot.model.frames[robot.frame_id(name)]
        place = np.asarray(frame.placement.homogeneous)
        for visual in visuals:
            material = visual.find("material")
            if hide and material is not None and material.get("name") == hide:
                continue
            for piece in _visual(visual, colours, robot.mesh_dirs, budget):
                found[int(frame.parentJoint)].append(_moved(piece, place))
    return found


def _moved(piece: Piece, place: Array) -> Piece:
    lines = piece.lines
    if lines is not None:
        lines = lines @ place[:3, :3].T + place[:3, 3]
    return Piece(piece.solid.moved(place) if piece.solid is not None else None, piece.look, lines)


def _visual(visual: etree._Element, colours: dict[str, Array], mesh_dirs: tuple[Path, ...], budget: int) -> list[Piece]:
    look = _look(visual.find("material"), colours)
    place = _origin(visual.find("origin"))
    shape = next(iter(visual.find("geometry")), None) if visual.find("geometry") is not None else None
    if shape is None or not isinstance(shape.tag, str):
        return []
    if shape.tag == "mesh":
        path = mesh_path(shape.get("filename") or "", mesh_dirs)
        if path is None:
            return []
        scale = np.diag([*_numbers(shape.get("scale") or "1 1 1", 3), 1.0])
        parts = read_mesh(path, budget)
        return [_moved(Piece(s, look or own or Look()), place @ scale) for s, own in parts]
    found = [Piece(_primitive(shape), look or Look())]
    name = (visual.find("material").get("name") or "") if visual.find("material") is not None else ""
    if shape.tag == "box" and "panel" in name:
        found.append(Piece(None, Look((0.62, 0.68, 0.8)), _cells(_numbers(shape.get("size") or "", 3))))
    return [_moved(piece, place) for piece in found]


def _primitive(shape: etree._Element) -> Solid:
    if shape.tag == "box":
        x, y, z = _numbers(shape.get("size") or "", 3)
        return box((x, y, z))
    radius = _numbers(shape.get("radius") or "", 1)[0]
    if shape.tag == "sphere":
        return sphere(radius)
    length = _numbers(shape.get("length") or "", 1)[0]
    return capsule(radius, length) if shape.tag == "capsule" else cylinder(radius, length)


def _cells(size: Array, pitch: float = 0.06) -> Array:
    """Lines between the cells of a solar panel, on both of its faces, shape (K, 2, 3)."""
    x, y, z = size / 2.0
    lines = []
    for side in (-1.0, 1.0):
        h = side * (z + 0.0006)
        for i in np.linspace(-x, x, max(2, round(2 * x / pitch)) + 1)[1:-1]:
            lines.append([(i, -y, h), (i, y, h)])
        for j in np.linspace(-y, y, max(2, round(2 * y / pitch)) + 1)[1:-1]:
            lines.append([(-x, j, h), (x, j, h)])
    return np.array(lines)


def _colours(root: etree._Element) -> dict[str, Array]:
    found = {}
    for material in root.iter("material"):
        colour = material.find("color")
        if colour is not None and material.get("name"):
            found[str(material.get("name"))] = _numbers(colour.get("rgba") or "", 4)
    return found


def _look(material: etree._Element | None, colours: dict[str, Array]) -> Look | None:
    if material is None:
        return None
    colour = material.find("color")
    name = material.get("name") or ""
    rgba = _numbers(colour.get("rgba") or "", 4) if colour is not None else colours.get(name)
    if rgba is None:
        return None
    like = next((look for word, look in _METAL.items() if word in name.lower()), Look())
    red, green, blue, opacity = (float(v) for v in np.clip(rgba, 0.0, 1.0))
    return Look((red, green, blue), opacity if opacity > 0.05 else 1.0, like.metal, like.rough)


def _origin(element: etree._Element | None) -> Array:
    placement = np.eye(4)
    if element is not None:
        placement[:3, :3] = pin.rpy.rpyToMatrix(*_numbers(element.get("rpy") or "0 0 0", 3))
        placement[:3, 3] = _numbers(element.get("xyz") or "0 0 0", 3)
    return placement


def _numbers(text: str, count: int) -> Array:
    try:
        values = np.array([float(v) for v in text.split()])
    except ValueError:
        raise InputError("URDF: not a list of numbers", given=text) from None
    if values.shape != (count,) or not np.all(np.isfinite(values)):
        raise InputError("URDF: wrong list of numbers", given=text, valid=f"{count} numbers")
    return values
