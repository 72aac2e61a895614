"""The study's robot, with what the study believes of single links."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from lxml import etree

from spacerobot.model.library import load
from spacerobot.model.robot import Robot
from spacerobot.recordings.rig_robot import study_robot
from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError, NotFoundError


def robot_of(study: Study, *, floating: bool | None = None) -> Robot:
    """The robot of the baseline; `link.NAME.mass` scales that link's inertia with its mass, `.inertia` states it.

    Raises:
        InputError: the study has no robot.
        NotFoundError: a link that the robot does not have.
    """
    masses = {n.split(".")[1]: v for n, v in study.values().items() if n.startswith("link.") and n.endswith(".mass")}
    robot = study_robot(study, floating=floating)
    return with_masses(robot, masses, where=str(study.path), floating=floating) if masses else robot


def with_masses(robot: Robot, masses: Mapping[str, float], *, where: str = "", floating: bool | None = None) -> Robot:
    """The robot with other masses of some links [kg]; each link's inertia is scaled with its mass.

    Raises:
        InputError: a link without mass.
        NotFoundError: a link that the robot does not have.
    """
    root = etree.fromstring(robot.urdf.encode())
    bodies = _bodies(root)
    for name, mass in masses.items():
        ratio = mass / _mass(bodies, name, where)
        bodies[name].find("mass").set("value", repr(mass))
        inertia = bodies[name].find("inertia")
        for key, value in inertia.attrib.items():
            inertia.set(key, repr(float(value) * ratio))
    return load(etree.tostring(root).decode(), floating=floating)


def mass_of(robot: Robot, link: str, where: str = "") -> float:
    """Mass of a link [kg].

    Raises:
        InputError: it has none.
        NotFoundError: the robot does not have it.
    """
    return _mass(_bodies(etree.fromstring(robot.urdf.encode())), link, where)


def weighed_links(robot: Robot, doubted: Iterable[str], joints: Iterable[str]) -> dict[str, float]:
    """Link -> mass [kg], of the links that move with one of these joints and have a value of doubt.

    Args:
        robot: as the study believes it.
        doubted: values by dotted name; those that are no link's are left out.
        joints: by name.

    Raises:
        InputError: a link without mass.
        NotFoundError: a link that the robot does not have.
    """
    masses = {n.split(".")[1]: mass_of(robot, n.split(".")[1]) for n in doubted if n.startswith("link.")}
    carried = robot.links_on(joints)
    return {n: m for n, m in masses.items() if n in carried}


def twice_as_heavy(robot: Robot, masses: Mapping[str, float]) -> dict[str, Robot]:
    """Link -> the robot with that link's mass and inertia doubled: what all is linear in needs no more to be known."""
    return {n: with_masses(robot, {n: 2.0 * m}, floating=robot.floating) for n, m in masses.items()}


def _bodies(root: Any) -> dict[str, Any]:
    """Link -> its inertial element, None where it has none."""
    return {link.get("name"): link.find("inertial") for link in root.iter("link")}


def _mass(bodies: Mapping[str, Any], link: str, where: str) -> float:
    if link not in bodies:
        raise NotFoundError("link", link, bodies, where=where)
    if bodies[link] is None or float(bodies[link].find("mass").get("value")) == 0.0:
        raise InputError("the link has no mass to change", given=link, where=where)
    return float(bodies[link].find("mass").get("value"))
