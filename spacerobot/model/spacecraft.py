"""Spacecraft under arms: a box with solar panels, or a URDF of the user's own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from lxml import etree

from spacerobot.model import shapes
from spacerobot.model.build import rebuild
from spacerobot.model.bus import COLOURS, draw_bus, inertia_matrix, require_number, require_triples
from spacerobot.model.floating import float_root
from spacerobot.model.inertia import inertia_fault
from spacerobot.model.library import load
from spacerobot.model.reading import parse
from spacerobot.model.robot import Robot
from spacerobot.model.tips import Tree
from spacerobot.support.errors import InputError, NotFoundError

ARM_MOUNT = "arm_mount"


@dataclass(frozen=True)
class SpacecraftSpec:
    """A rigid spacecraft body.

    Attributes:
        mass: [kg].
        size: edges of the bus [m]; the body frame is at its centre.
        inertia: about the centre of mass in body axes [kg m^2]: three principal moments or a (3, 3) nesting;
            that of a uniform box if None.
        com: centre of mass in the body frame [m].
        mount: where the arm stands, in the body frame [m]; the middle of the top face (+z) if None.
        mount_rpy: roll, pitch, yaw of the arm's base in the body frame [rad].
        panels: whether solar panels are drawn; they carry no mass of their own.
    """

    mass: float = 500.0
    size: tuple[float, float, float] = (1.2, 1.2, 1.0)
    inertia: tuple[float, ...] | tuple[tuple[float, ...], ...] | None = None
    com: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mount: tuple[float, float, float] | None = None
    mount_rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    panels: bool = True

    def __post_init__(self) -> None:
        require_number(self, "mass")
        require_triples(self, "size", "com", "mount", "mount_rpy")
        if min(self.size) <= 0:
            raise InputError("spacecraft size is not positive", given=self.size, valid="three positive lengths")
        fault = inertia_fault(self.mass, self.inertia_matrix())
        if fault:
            raise InputError(f"spacecraft cannot exist: {fault}")

    def inertia_matrix(self) -> np.ndarray:
        """Shape (3, 3), about the centre of mass, body axes [kg m^2]."""
        return inertia_matrix(self.inertia, self.mass, self.size, "spacecraft")


def spacecraft_body(spec: SpacecraftSpec) -> etree._Element:
    """A spacecraft as a `<robot>` element with the links `spacecraft` and `arm_mount`."""
    root = etree.Element("robot", name="chaser")
    shapes.add_materials(root, COLOURS)
    body = shapes.link("spacecraft", mass=spec.mass, com=spec.com, inertia=spec.inertia_matrix())
    draw_bus(body, spec.size, panels=spec.panels)
    mount = spec.mount if spec.mount is not None else (0.0, 0.0, spec.size[2] / 2)
    root.append(body)
    root.append(shapes.link(ARM_MOUNT))
    root.append(shapes.joint("arm_mount_joint", "fixed", "spacecraft", ARM_MOUNT, xyz=mount, rpy=spec.mount_rpy))
    return root


def float_base(
    robot: Robot, spacecraft: SpacecraftSpec | str | Path | None = None, *, mount: str | None = None
) -> Robot:
    """Put an arm on a free-flying spacecraft.

    Args:
        robot: an arm with a fixed base.
        spacecraft: its measures, or a URDF by name, path or text (see `load`); the default measures if None.
        mount: frame of the spacecraft that the arm stands on; `arm_mount` if it has one, else its root link.

    Returns:
        the chaser: first joint `root_joint` (free-flyer), the arm's base fixed to the spacecraft.

    Raises:
        InputError: the robot floats already, or the two share a name.
        NotFoundError: no such spacecraft or frame.
    """
    if robot.floating:
        raise InputError("robot floats already", given=robot.name)
    craft, label, folders = _craft(spacecraft)
    arm = parse(robot.urdf, robot.name)
    arm_tree, craft_tree = Tree(arm), Tree(craft)
    frame = mount or (ARM_MOUNT if ARM_MOUNT in craft_tree.links else craft_tree.root)
    stand = craft_tree.link_of(frame)
    if stand is None:
        raise NotFoundError("frame of the spacecraft", frame, [*craft_tree.links, *craft_tree.joints])
    for kind, ours, theirs in (
        ("link", arm_tree.links, craft_tree.links),
        ("joint", arm_tree.joints, craft_tree.joints),
    ):
        shared = sorted(set(ours) & set(theirs))
        if shared:
            raise InputError(f"arm and spacecraft share a {kind} name", given=", ".join(shared))
    known = {material.get("name") for material in craft.findall("material")}
    for element in arm:
        if not (element.tag == "material" and element.get("name") in known):
            craft.append(element)
    base = "arm_base_joint"
    if base in arm_tree.joints:
        raise InputError("arm has a joint of the name that joins it to the spacecraft", given=base)
    craft.append(shapes.joint(base, "fixed", stand, arm_tree.root))
    float_root(craft)
    etree.indent(craft)
    name = f"{label}_{robot.name}"
    craft.set("name", name)
    merged = replace(robot, mesh_dirs=(*robot.mesh_dirs, *folders))
    return rebuild(merged, craft, name=name, tip=None if robot.slider else robot.tip)


def _craft(spacecraft: SpacecraftSpec | str | Path | None) -> tuple[etree._Element, str, tuple[Path, ...]]:
    if spacecraft is None or isinstance(spacecraft, SpacecraftSpec):
        return spacecraft_body(spacecraft or SpacecraftSpec()), "chaser", ()
    loaded = load(spacecraft)
    if loaded.chain or loaded.slider:
        raise InputError("spacecraft is a robot with joints", given=loaded.name, valid="one rigid body")
    root = parse(loaded.urdf, loaded.name)
    if loaded.floating:  # the joint is made anew above the assembly
        tree = Tree(root)
        floating = next(name for name in tree.joints if tree.kind(name) == "floating")
        root.remove(next(link for link in root.findall("link") if link.get("name") == tree.parent(floating)))
        root.remove(tree.joints[floating])
    return root, loaded.name, loaded.mesh_dirs
