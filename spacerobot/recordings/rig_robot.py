"""The robot of a study: its URDF as published, impossible inertias mended, with what the study believes of links."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from lxml import etree

from spacerobot.model.library import load
from spacerobot.model.robot import Robot
from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError, NotFoundError


def study_robot(study: Study, *, floating: bool | None = None, default: str | None = None) -> Robot:
    """The robot of the baseline, with the inertias that the study states for single links.

    Args:
        study: the study.
        floating: see `model.library.load`.
        default: robot where the study names none.

    Raises:
        InputError: the study names no robot, or its URDF cannot be read.
        NotFoundError: a link that the robot does not have.
    """
    source = study.robot_source or default
    if source is None:
        raise InputError("the study names no robot", where=str(study.path))
    stated = stated_inertias(study.values())
    if not stated:
        return load(source, floating=floating, mend=True)
    text = source.read_text(encoding="utf-8") if isinstance(source, Path) else load(source, mend=True).urdf
    root = etree.fromstring(text.encode())
    bodies = {link.get("name"): link.find("inertial") for link in root.iter("link")}
    for name, moments in stated.items():
        if name not in bodies:
            raise NotFoundError("link", name, bodies, where=str(study.path))
        if bodies[name] is None:
            raise InputError("the link has no inertia to change", given=name, where=str(study.path))
        _state(bodies[name].find("inertia"), moments)
    folders = [source.parent] if isinstance(source, Path) else []
    return load(etree.tostring(root).decode(), floating=floating, package_dirs=folders, mend=True)


def sliding_joints(study: Study) -> frozenset[str]:
    """Joints that slide in the study's robot: files say neither that nor, often, a unit. None where it has no robot."""
    try:
        robot = study_robot(study)
    except InputError:
        return frozenset()
    return frozenset(str(row["name"]) for row in robot.joint_rows() if row["unit"] == "m")


def mended_links(robot: Robot) -> list[str]:
    """What was mended in a study's robot, a warning each."""
    return [f"robot: {text} (or state link.NAME.inertia)" for text in robot.mended]


def stated_inertias(values: Mapping[str, float]) -> dict[str, dict[str, float]]:
    """Link -> axis -> principal moment, kg m2, of the links whose `inertia` the study states."""
    found: dict[str, dict[str, float]] = {}
    for name, value in values.items():
        parts = name.split(".")
        if len(parts) == 4 and parts[0] == "link" and parts[2] == "inertia":
            found.setdefault(parts[1], {})[parts[3]] = value
    return found


def _state(element: Any, moments: Mapping[str, float]) -> None:
    for key in ("ixy", "ixz", "iyz"):
        element.set(key, "0")
    for axis, value in moments.items():
        element.set(f"i{axis}{axis}", repr(value))
