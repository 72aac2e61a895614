"""The baseline: the model a lab believes in, before anything is compared with a recording."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from spacerobot.recordings.document import Document
from spacerobot.recordings.sigmas import flat, read_sigma, relative
from spacerobot.recordings.values import GROUPS, kind, read_values
from spacerobot.support.errors import InputError, NotFoundError

DEFAULT_POSE = tuple(math.radians(d) for d in (0.0, 45.0, 0.0, 90.0, 0.0, -45.0, 0.0))
"""Joint angles of a seven-joint arm where the study states none, rad."""

BASES = ("fixed", "free")
JOINTS = ("locked", "free", "servo")
LAWS = ("kelvin_voigt", "hertz", "hunt_crossley", "none")

_PLAIN = ("robot", "base", "joints", "pose", "pose_deg", "approach", "gravity", "exact")
_TABLES = ("wrist", "contact", "target", "body", "hand", "platform", "joint", "link", "sigma", "scatter")


@dataclass(frozen=True)
class Baseline:
    """What the lab believes.

    Attributes:
        robot: bundled name, example-robot-data name, URDF path relative to the study, or None for a
            free body alone.
        base: "fixed" or "free".
        joints: "locked", "free" or "servo".
        pose: joint positions from base to tip, rad.
        pose_stated: whether the study says the pose; else it is DEFAULT_POSE.
        approach: unit vector, world axes: the target's direction of motion.
        gravity: acceleration, world axes, m/s2.
        values: dotted name -> believed value, SI. Absent means unknown: to be fitted.
        unknown: dotted names that the study states as "unknown".
        law: contact law, one of LAWS.
        sigma: dotted name -> one standard deviation of the believed value, relative.
        absolute: dotted name -> one standard deviation of a value that is believed to be zero, SI.
        scatter: dotted name -> one standard deviation of its change between conditions, relative.
        exact: dotted names of values that are held as they are stated.
    """

    robot: str | None
    base: str = "fixed"
    joints: str = "locked"
    pose: tuple[float, ...] = DEFAULT_POSE
    pose_stated: bool = False
    approach: tuple[float, float, float] = (1.0, 0.0, 0.0)
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    values: Mapping[str, float] = field(default_factory=dict)
    unknown: frozenset[str] = frozenset()
    law: str = "kelvin_voigt"
    sigma: Mapping[str, float] = field(default_factory=dict)
    absolute: Mapping[str, float] = field(default_factory=dict)
    scatter: Mapping[str, float] = field(default_factory=dict)
    exact: frozenset[str] = frozenset()


def read_baseline(document: Document) -> Baseline:
    """The `[baseline]` table of a study, checked.

    Raises:
        InputError: an unknown key, or a value that no rig can have.
    """
    table = document.table(document.data, "baseline")
    document.check_keys({k: v for k, v in table.items() if "." not in k}, (*_PLAIN, *_TABLES), "baseline")
    for name, value in table.items():
        if name in _TABLES and not isinstance(value, dict):
            raise InputError(f"{name!r} must be a table", given=value, where=document.where("baseline", name))
    physical = flat(document, {k: v for k, v in table.items() if k not in (*_PLAIN, "sigma", "scatter")}, "baseline")
    law = physical.pop("contact.law", "kelvin_voigt")
    if law not in LAWS:
        raise NotFoundError("contact law", str(law), LAWS, where=document.where("baseline", "contact", "law"))
    stated, pose = read_pose(document, table, "baseline")
    values = read_values(document, physical, "baseline")
    sigma, absolute = read_sigma(document, table, values)
    robot = table.get("robot")
    if robot is not None and (not isinstance(robot, str) or not robot.strip(" <") or set(robot) & set("\0\n<")):
        raise InputError("robot must be a name or a URDF path", given=robot, where=document.where("baseline", "robot"))
    alone = "body" in table or ("target" in table and not {"wrist", "contact"} & set(table))
    if robot is None and not alone:
        raise InputError(
            "the baseline names no robot",
            valid="robot = NAME, or a [baseline.body] (or [baseline.target]) alone",
            where=document.where("baseline"),
        )
    return Baseline(
        robot=robot,
        base=_choice(document, table, "base", BASES),
        joints=_choice(document, table, "joints", JOINTS),
        pose=pose if stated else DEFAULT_POSE,
        pose_stated=stated,
        approach=_approach(document, table),
        gravity=_three(document, table, "gravity", (0.0, 0.0, 0.0)),
        values={**dict.fromkeys(absolute, 0.0), **values},
        unknown=frozenset(name for name, value in physical.items() if value == "unknown"),
        law=law,
        sigma=sigma,
        absolute=absolute,
        scatter=relative(document, table, "scatter"),
        exact=_exact(document, table, {**sigma, **absolute}),
    )


def read_pose(document: Document, table: Mapping[str, Any], *path: str | int) -> tuple[bool, tuple[float, ...]]:
    """Whether `pose` (rad) or `pose_deg` is stated in `table`, and the joint positions in rad."""
    if "pose" in table and "pose_deg" in table:
        raise InputError(
            "pose and pose_deg are both given", valid="one of them", where=document.where(*path, "pose_deg")
        )
    if "pose_deg" in table:
        return True, tuple(math.radians(v) for v in document.vector(table["pose_deg"], None, *path, "pose_deg"))
    if "pose" not in table:
        return False, ()
    pose = document.vector(table["pose"], None, *path, "pose")
    if any(abs(v) > 4 * math.pi for v in pose):
        raise InputError(
            "pose is in rad and turns more than twice",
            given=list(pose),
            valid="pose in rad, or pose_deg in degrees",
            where=document.where(*path, "pose"),
        )
    return True, pose


def _choice(document: Document, table: Mapping[str, Any], key: str, known: tuple[str, ...]) -> str:
    value = document.text(table, key, known[0], "baseline")
    if value not in known:
        raise NotFoundError(f"value of {key!r}", value, known, where=document.where("baseline", key))
    return value


def _three(
    document: Document, table: Mapping[str, Any], key: str, default: tuple[float, float, float]
) -> tuple[float, float, float]:
    if key not in table:
        return default
    x, y, z = document.vector(table[key], 3, "baseline", key)
    return x, y, z


def _approach(document: Document, table: Mapping[str, Any]) -> tuple[float, float, float]:
    vector = _three(document, table, "approach", (1.0, 0.0, 0.0))
    length = math.hypot(*vector)
    if not abs(length - 1.0) < 1e-6:
        valid = "length 1" if not 0 < length < math.inf else f"e.g. {[round(v / length, 9) for v in vector]}"
        raise InputError(
            "approach must be a unit vector",
            given=list(vector),
            valid=valid,
            where=document.where("baseline", "approach"),
        )
    return vector


def _exact(document: Document, table: Mapping[str, Any], sigma: Mapping[str, float]) -> frozenset[str]:
    """`exact = ["wrist.mass"]`, at the top of a study or in its baseline: values that are held as stated."""
    found = set()
    for given, path in ((document.data.get("exact", []), ("exact",)), (table.get("exact", []), ("baseline", "exact"))):
        where = document.where(*path)
        if not isinstance(given, list) or not all(isinstance(name, str) for name in given):
            raise InputError("'exact' must be a list of names", given=given, valid='["wrist.mass"]', where=where)
        for name in given:
            kind(name, where=where)
            if sigma.get(name):
                raise InputError("a value cannot be exact and have a sigma", given=name, where=where)
            found.add(name)
    return frozenset(found)


assert set(_TABLES) - {"sigma", "scatter"} == {g.split(".")[0] for g in GROUPS}  # one list, two readers
