"""The prismatic compliant wrist: a slider along the mount's z, put on any arm at any frame.

Frames and signs: `wrist_mount` is fixed to the arm, its z points outward. The joint `wrist_slider` moves the
slider along minus z, so that a positive value is PUSHED IN, toward the arm, which is the sign of `wrist.x`.
`wrist_tip` is the point that touches. Spring and damper are no part of the robot: a scene sets them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from lxml import etree

from spacerobot.model import shapes
from spacerobot.model.build import CONTACT, MOUNT, SLIDER, rebuild
from spacerobot.model.bus import require_number
from spacerobot.model.reading import parse
from spacerobot.model.robot import Robot
from spacerobot.model.tips import Tree
from spacerobot.support.errors import InputError, NotFoundError

MOUNT_JOINT = "wrist_mount_joint"
COLOURS = {
    "wrist_steel": "0.74 0.76 0.80 1",
    "wrist_housing": "0.20 0.22 0.26 1",
    "wrist_spring": "0.86 0.55 0.13 1",
    "wrist_tip": "0.80 0.16 0.16 1",
}


@dataclass(frozen=True)
class WristSpec:
    """Measures of a wrist.

    Attributes:
        mass: of the slider with its tip [kg].
        length: from the mount to the tip with the spring at rest [m].
        travel: of the slider to either side of rest [m].
        tip_radius: of the round tip [m].
        mount_mass: of the housing, fixed to the arm [kg].
    """

    mass: float = 0.7
    length: float = 0.16
    travel: float = 0.06
    tip_radius: float = 0.015
    mount_mass: float = 0.0

    def __post_init__(self) -> None:
        require_number(self, "mass", "length", "travel", "tip_radius", "mount_mass")
        for name in ("mass", "length", "travel", "tip_radius"):
            value = getattr(self, name)
            if value <= 0:
                raise InputError(f"wrist {name} is not positive", given=value, valid="a positive number")
        if self.mount_mass < 0:
            raise InputError("wrist mount_mass is negative", given=self.mount_mass, valid="zero or more")
        if self.travel >= self.length:
            raise InputError("wrist travel exceeds its length", given=self.travel, valid=f"below {self.length} m")
        if 2 * self.tip_radius >= self.length:
            raise InputError("wrist tip is longer than the wrist", given=self.tip_radius)


def attach_wrist(
    robot: Robot,
    tip: str | None = None,
    wrist: WristSpec | None = None,
    *,
    rotation: np.ndarray | None = None,
) -> Robot:
    """Put a wrist on an arm.

    Args:
        robot: any arm without a wrist.
        tip: link or joint whose frame carries the mount; the arm's tip if None.
        wrist: its measures; the defaults if None.
        rotation: shape (3, 3), of the mount in the tip's frame; its z column is the slider's outward axis.
            The tip's own z if None. `aim` finds it from a direction in the world.

    Raises:
        InputError: the robot has a wrist, uses one of its names, or `rotation` is no rotation.
        NotFoundError: no such frame.
    """
    if robot.slider is not None:
        raise InputError("robot has a wrist already", given=robot.name)
    wrist = wrist or WristSpec()
    root = parse(robot.urdf, robot.name)
    tree = Tree(root)
    link = tree.link_of(tip or robot.tip)
    if link is None:
        raise NotFoundError("frame", str(tip), [*tree.links, *tree.joints])
    rpy = np.zeros(3) if rotation is None else pin.rpy.matrixToRpy(_rotation(rotation))
    shapes.add_materials(root, COLOURS)
    for element in wrist_elements(wrist, link, rpy):
        root.append(element)
    etree.indent(root)
    return rebuild(robot, root, name=f"{robot.name}_wrist")


def wrist_elements(wrist: WristSpec, parent: str, rpy: np.ndarray | tuple[float, ...]) -> list[etree._Element]:
    """Links and joints of a wrist whose mount sits on link `parent`, turned by roll, pitch, yaw [rad]."""
    radius, housing = 1.6 * wrist.tip_radius, 0.4 * wrist.length
    mount = shapes.link(
        MOUNT,
        mass=wrist.mount_mass,
        com=(0, 0, housing / 2),
        inertia=shapes.solid_cylinder(wrist.mount_mass, radius, housing),
    )
    shapes.add_shape(mount, "cylinder", (1.5 * radius, 0.008), (0, 0, 0.004), material="wrist_steel")
    shapes.add_shape(mount, "cylinder", (radius, housing), (0, 0, housing / 2), material="wrist_housing")
    shapes.add_shape(mount, "cylinder", (radius, housing), (0, 0, housing / 2))

    rod = wrist.length - wrist.tip_radius
    slider = shapes.link(
        "wrist_rod",
        mass=wrist.mass,
        com=(0, 0, wrist.length / 2),
        inertia=shapes.solid_cylinder(wrist.mass, 0.6 * wrist.tip_radius, wrist.length),
    )
    shapes.add_shape(slider, "cylinder", (0.5 * wrist.tip_radius, rod), (0, 0, rod / 2), material="wrist_steel")
    coils, start = 6, housing + 0.01
    for i in range(coils):
        z = start + (rod - wrist.tip_radius - start) * (i + 0.5) / coils
        shapes.add_shape(slider, "cylinder", (0.85 * wrist.tip_radius, 0.004), (0, 0, z), material="wrist_spring")
    shapes.add_shape(slider, "sphere", (wrist.tip_radius,), (0, 0, rod), material="wrist_tip")
    shapes.add_shape(slider, "sphere", (wrist.tip_radius,), (0, 0, rod))

    moving = shapes.joint(SLIDER, "prismatic", MOUNT, "wrist_rod")
    etree.SubElement(moving, "axis", xyz="0 0 -1")
    bound = shapes.text(wrist.travel)
    etree.SubElement(moving, "limit", lower=f"-{bound}", upper=bound, effort="1000", velocity="10")
    return [
        mount,
        shapes.joint(MOUNT_JOINT, "fixed", parent, MOUNT, rpy=rpy),
        slider,
        moving,
        shapes.link(CONTACT),
        shapes.joint("wrist_tip_joint", "fixed", "wrist_rod", CONTACT, xyz=(0, 0, wrist.length)),
    ]


def aim(robot: Robot, pose: np.ndarray, approach: np.ndarray) -> Robot:
    """Turn the wrist's mount so that its outward axis points along minus `approach`.

    The target comes along `approach`, the wrist points at it. The mount turns about its own origin, the
    shortest way from the z of the frame that carries it, however the wrist was aimed before.

    Args:
        robot: an arm with a wrist, its base at the world's origin.
        pose: shape (len(chain),), joint positions [rad or m].
        approach: shape (3,), unit vector in world axes.

    Raises:
        InputError: no wrist, or `approach` is no unit vector.
    """
    if robot.slider is None:
        raise InputError("robot has no wrist to aim", given=robot.name, valid="attach_wrist(robot) first")
    direction = np.asarray(approach, dtype=float)
    if direction.shape != (3,) or not np.isfinite(direction).all() or abs(np.linalg.norm(direction) - 1) > 1e-6:
        raise InputError("approach is not a unit vector", given=approach, valid="three numbers of length 1")
    root = parse(robot.urdf, robot.name)
    tree = Tree(root)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(pose))
    mount = tree.above[MOUNT]
    carrier = data.oMf[robot.frame_id(tree.parent(mount))].rotation
    element = tree.joints[mount].find("origin")
    if element is None:
        element = etree.SubElement(tree.joints[mount], "origin", xyz="0 0 0")
    element.set("rpy", shapes.text(pin.rpy.matrixToRpy(shortest_turn(-carrier.T @ direction))))
    return rebuild(robot, root)


def shortest_turn(to: np.ndarray) -> np.ndarray:
    """Shape (3, 3): smallest rotation that takes z to the unit vector `to`; about x if opposite."""
    z = np.array([0.0, 0.0, 1.0])
    axis = np.cross(z, to)
    sine, cosine = float(np.linalg.norm(axis)), float(to[2])
    if sine < 1e-12:
        return np.eye(3) if cosine > 0 else np.diag([1.0, -1.0, -1.0])
    return pin.exp3(axis / sine * np.arctan2(sine, cosine))


def _rotation(matrix: np.ndarray) -> np.ndarray:
    matrix = np.asarray(matrix, dtype=float)
    if matrix.shape != (3, 3) or not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-9) or np.linalg.det(matrix) < 0:
        raise InputError("mount rotation is not a rotation matrix", given=matrix.tolist())
    return matrix
