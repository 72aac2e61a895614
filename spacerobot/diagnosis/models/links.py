"""The study's robot, with what the study believes of single links."""

from __future__ import annotations

from lxml import etree

from spacerobot.model.library import load
from spacerobot.model.robot import Robot
from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError, NotFoundError


def robot_of(study: Study, *, floating: bool | None = None) -> Robot:
    """The robot of the baseline; `link.NAME.mass` scales that link's inertia with its mass.

    Raises:
        InputError: the study has no robot.
        NotFoundError: a link that the robot does not have.
    """
    source = study.robot_source
    if source is None:
        raise InputError("the study names no robot", where=str(study.path))
    masses = {n.split(".")[1]: v for n, v in study.values().items() if n.startswith("link.") and n.endswith(".mass")}
    robot = load(source, floating=floating)
    if not masses:
        return robot
    root = etree.fromstring(robot.urdf.encode())
    links = {link.get("name"): link for link in root.iter("link")}
    for name, mass in masses.items():
        if name not in links:
            raise NotFoundError("link", name, links, where=str(study.path))
        body = links[name].find("inertial")
        if body is None or float(body.find("mass").get("value")) == 0.0:
            raise InputError("the link has no mass to change", given=name, where=str(study.path))
        ratio = mass / float(body.find("mass").get("value"))
        body.find("mass").set("value", repr(mass))
        inertia = body.find("inertia")
        for key, value in inertia.attrib.items():
            inertia.set(key, repr(float(value) * ratio))
    return load(etree.tostring(root).decode(), floating=floating)
