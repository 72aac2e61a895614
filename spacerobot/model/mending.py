"""Inertias of published URDFs that no body can have, moved to the nearest that one can."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
from lxml import etree

from spacerobot.model.inertia import inertia_fault, moving_links

DENSEST = 22_600.0
"""Density of osmium, kg/m3: no body of a mass is more compact than a sphere of it."""


def nearest_possible(mass: float, inertia: np.ndarray) -> np.ndarray:
    """The nearest inertia (Frobenius norm) to `inertia` that a body of this mass can have.

    Principal axes stay. Principal moments are projected on the triangle inequality, and on what the densest sphere of
    the mass has at least.

    Args:
        mass: [kg], positive.
        inertia: shape (3, 3), about the centre of mass [kg m^2].

    Returns:
        shape (3, 3), [kg m^2].
    """
    moments, axes = np.linalg.eigh(0.5 * (inertia + inertia.T))
    least = 0.4 * mass * (3 * mass / (4 * math.pi * DENSEST)) ** (2 / 3)
    moments = np.maximum(moments, least)
    low, middle, high = moments
    excess = high - low - middle
    if excess > 0:  # the nearest point of the plane low + middle = high
        moments = np.array([low + excess / 3, middle + excess / 3, high - excess / 3])
    mended: np.ndarray = (axes * moments) @ axes.T
    return mended


def mend(root: etree._Element, model: pin.Model) -> tuple[str, ...]:
    """Mend the impossible bodies of a URDF in place.

    Args:
        root: the `<robot>` element.
        model: built from it.

    Returns:
        What was changed, a line for each link. Bodies without mass stay as they are: nothing is nearest to them.
    """
    links = {link.get("name"): link for link in root.findall("link")}
    said = []
    for joint in range(1, model.njoints):
        body = model.inertias[joint]
        fault = inertia_fault(body.mass, body.inertia)
        moving = moving_links(model, joint)
        if fault is None or not moving or not body.mass > 0 or not np.all(np.isfinite(body.inertia)):
            continue
        inertial = next((e for n in moving if (e := links[n].find("inertial")) is not None), None)
        owner = next((n for n in moving if links[n].find("inertial") is not None), None)
        if inertial is None or owner is None:
            continue
        change = nearest_possible(body.mass, body.inertia) - body.inertia
        turn = model.frames[model.getFrameId(owner, pin.FrameType.BODY)].placement.rotation @ _turn(inertial)
        _add(inertial.find("inertia"), turn.T @ change @ turn)
        size = float(np.linalg.norm(change) / max(float(np.linalg.norm(body.inertia)), 1e-300))
        by = f"by {size:.2g} of itself" if np.linalg.norm(body.inertia) > 0 else "from zero"
        said.append(f"link {owner}: {fault}; moved {by} to the nearest that a body can have")
    return tuple(said)


def _turn(inertial: etree._Element) -> np.ndarray:
    """Rotation from the inertial's axes to the link's."""
    origin = inertial.find("origin")
    rpy = (origin.get("rpy") if origin is not None else None) or "0 0 0"
    matrix: np.ndarray = pin.rpy.rpyToMatrix(*map(float, rpy.split()))
    return matrix


def _add(element: etree._Element, change: np.ndarray) -> None:
    for i, j, key in ((0, 0, "ixx"), (1, 1, "iyy"), (2, 2, "izz"), (0, 1, "ixy"), (0, 2, "ixz"), (1, 2, "iyz")):
        element.set(key, repr(float(element.get(key, "0")) + float(change[i, j])))
