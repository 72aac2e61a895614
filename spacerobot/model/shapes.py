"""Small pieces of URDF: links, joints and primitive shapes as XML elements."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from lxml import etree

ALONG_X = (0.0, np.pi / 2, 0.0)
"""Roll, pitch, yaw that lay a cylinder along x."""

ALONG_Y = (np.pi / 2, 0.0, 0.0)
"""Roll, pitch, yaw that lay a cylinder along y."""


def text(values: float | Sequence[float] | np.ndarray) -> str:
    """Numbers as URDF writes them: the shortest text that reads back exactly."""
    plain = np.atleast_1d(np.asarray(values, dtype=float)) + 0.0  # turns -0.0 into 0.0
    return " ".join(f"{v:.0f}" if v == int(v) and abs(v) < 1e6 else repr(float(v)) for v in plain)


def origin(parent: etree._Element, xyz: Sequence[float] | np.ndarray, rpy: Sequence[float] | np.ndarray) -> None:
    """An `<origin>` under `parent`: translation [m] and roll, pitch, yaw [rad]."""
    element = etree.SubElement(parent, "origin", xyz=text(xyz))
    if np.any(np.asarray(rpy) != 0):
        element.set("rpy", text(rpy))


def link(
    name: str, *, mass: float = 0.0, com: Sequence[float] = (0, 0, 0), inertia: np.ndarray | None = None
) -> etree._Element:
    """A link; without inertia it is a mere frame.

    Args:
        name: of the link.
        mass: [kg]; a zero is written where there is an inertia, for MuJoCo weighs the shapes of links that state none.
        com: shape (3,), centre of mass in the link frame [m].
        inertia: shape (3, 3), about the centre of mass [kg m^2].
    """
    element = etree.Element("link", name=name)
    if inertia is not None:
        inertial = etree.SubElement(element, "inertial")
        origin(inertial, com, (0, 0, 0))
        etree.SubElement(inertial, "mass", value=text(mass))
        keys = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}
        etree.SubElement(inertial, "inertia", **{k: text(inertia[ij]) for k, ij in keys.items()})
    return element


def joint(
    name: str,
    kind: str,
    parent: str,
    child: str,
    *,
    xyz: Sequence[float] | np.ndarray = (0, 0, 0),
    rpy: Sequence[float] | np.ndarray = (0, 0, 0),
) -> etree._Element:
    """A joint of type `kind`; axis and limits are the caller's."""
    element = etree.Element("joint", name=name, type=kind)
    etree.SubElement(element, "parent", link=parent)
    etree.SubElement(element, "child", link=child)
    origin(element, xyz, rpy)
    return element


def add_shape(
    to: etree._Element,
    shape: str,
    size: Sequence[float] | np.ndarray,
    xyz: Sequence[float] | np.ndarray,
    *,
    rpy: Sequence[float] = (0, 0, 0),
    material: str | None = None,
) -> None:
    """A primitive on a link: seen with a material, collided with without one.

    Args:
        to: the link.
        shape: "box" (three edges), "cylinder" (radius, length along z) or "sphere" (radius).
        size: the shape's measures [m].
        xyz: its centre in the link frame [m].
        rpy: its roll, pitch, yaw [rad].
        material: name of a material of the robot.
    """
    body = etree.SubElement(to, "collision" if material is None else "visual")
    size, xyz = np.round(size, 6), np.round(xyz, 6)
    origin(body, xyz, rpy)
    geometry = etree.SubElement(body, "geometry")
    if shape == "box":
        etree.SubElement(geometry, "box", size=text(size))
    elif shape == "cylinder":
        etree.SubElement(geometry, "cylinder", radius=text(size[0]), length=text(size[1]))
    else:
        etree.SubElement(geometry, "sphere", radius=text(size[0]))
    if material is not None:
        etree.SubElement(body, "material", name=material)


def add_materials(root: etree._Element, colours: dict[str, str]) -> None:
    """Named materials at the top of a robot (name -> "r g b a"), those it has already left alone."""
    known = {m.get("name") for m in root.findall("material")}
    for name, rgba in reversed([c for c in colours.items() if c[0] not in known]):
        material = etree.Element("material", name=name)
        etree.SubElement(material, "color", rgba=rgba)
        root.insert(0, material)


def solid_cylinder(mass: float, radius: float, length: float) -> np.ndarray:
    """Shape (3, 3): inertia of a uniform cylinder along z about its centre [kg m^2]."""
    across = mass * (3 * radius**2 + length**2) / 12
    return np.diag([across, across, mass * radius**2 / 2])


def solid_box(mass: float, size: Sequence[float]) -> np.ndarray:
    """Shape (3, 3): inertia of a uniform box about its centre [kg m^2]."""
    x, y, z = (s**2 for s in size)
    return mass / 12 * np.diag([y + z, x + z, x + y])
