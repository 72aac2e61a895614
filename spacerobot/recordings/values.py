"""The physical values that a baseline may believe, by dotted name: what is known and what each may be."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from spacerobot.recordings.document import Document
from spacerobot.simulation.parts.checks import SMALLEST
from spacerobot.support.errors import InputError, NotFoundError


@dataclass(frozen=True)
class Kind:
    """What a value may be.

    Attributes:
        minimum: lowest value, or None.
        strict: whether `minimum` itself is excluded.
        unit: SI unit, for the reader of a report.
        parts: names of the components of a vector, empty for a number.
    """

    minimum: float | None
    strict: bool
    unit: str
    parts: tuple[str, ...] = ()


def _positive(unit: str) -> Kind:
    return Kind(0.0, True, unit)


def _not_negative(unit: str) -> Kind:
    return Kind(0.0, False, unit)


def _any(unit: str, *parts: str) -> Kind:
    return Kind(None, False, unit, parts)


_RIGID: dict[str, Kind] = {
    "mass": _positive("kg"),
    "yaw_inertia": _positive("kg m2"),
    "inertia": Kind(0.0, True, "kg m2", ("x", "y", "z")),
    "com": _any("m", "x", "y", "z"),
    "contact_point": _any("m", "ahead", "lateral"),
    "radius": _positive("m"),
    "length": _positive("m"),
    "width": _positive("m"),
    "height": _positive("m"),
    "restitution": _not_negative("1"),
    "mu": _not_negative("1"),
    "damping": _not_negative("N s/m"),
    "yaw_damping": _not_negative("N m s/rad"),
}

_JOINT: dict[str, Kind] = {
    "mass": _positive("kg"),
    "inertia": _positive("kg m2"),
    "armature": _not_negative("kg m2"),
    "stiffness": _not_negative("N/m"),
    "damping": _not_negative("N s/m"),
    "friction": _not_negative("N"),
    "gain": _positive("1"),
    "bias": _any("N"),
    "torque": _any("N"),
    "zero": _any("rad"),
    "delay": _any("s"),
    "ratio": _any("1"),
    "kp": _not_negative("1"),
    "kv": _not_negative("1"),
}

GROUPS: dict[str, dict[str, Kind]] = {
    "wrist": {
        "mass": _positive("kg"),
        "stiffness": _not_negative("N/m"),
        "damping": _not_negative("N s/m"),
        "equivalent_damping": _not_negative("N s/m"),
        "travel": _positive("m"),
        "preload": _any("N"),
    },
    "contact": {
        "stiffness": _positive("N/m"),
        "damping": _not_negative("N s/m"),
        "exponent": _positive("1"),
        "restitution": _not_negative("1"),
        "mu": _not_negative("1"),
    },
    "target": _RIGID,
    "body": {**_RIGID, "delay": _any("s")},
    "hand": _RIGID,
    "platform": _RIGID,
    "joint.NAME": _JOINT,
    "link.NAME": _RIGID,
}
"""Group -> key -> kind. `platform`: the body of a free base; `body`: a free body alone; NAME: any name."""


def known_names() -> tuple[str, ...]:
    """Every dotted name, with NAME for that of a joint or link."""
    return tuple(f"{group}.{key}" for group, table in GROUPS.items() for key in table)


def kind(name: str, *, where: str | None = None) -> Kind:
    """The kind of the value called `name`; a vector's component ("target.contact_point.lateral") is a number.

    Raises:
        NotFoundError: no such value, with the nearest known one.
    """
    pattern = re.sub(r"^(joint|link)\.[^.]+\.", r"\1.NAME.", name)
    group, _, key = pattern.rpartition(".")
    found = GROUPS.get(group, {}).get(key)
    if found is not None:
        return found
    parent, _, vector = group.rpartition(".")
    whole = GROUPS.get(parent, {}).get(vector)
    if whole is not None and key in whole.parts:
        return Kind(whole.minimum, whole.strict, whole.unit)
    raise NotFoundError("value", name, known_names(), where=where)


def least_of(name: str) -> float:
    """The least that the value called `name` may be."""
    minimum = kind(name).minimum
    return -math.inf if minimum is None else minimum


def may_be_nothing(name: str) -> bool:
    """Whether the value called `name` may be zero, and no less: a damping may, a mass may not, nor what has no name."""
    try:
        found = kind(name)
    except NotFoundError:
        return False
    return found.minimum == 0.0 and not found.strict


def read_values(document: Document, flat: Mapping[str, Any], *path: str | int) -> dict[str, float]:
    """Checked values by dotted name; vectors are spread over their components.

    Args:
        document: for the line in an error.
        flat: dotted name -> number, list of numbers for a vector, or "unknown" (left out, as if absent).
        path: keys of the table that holds them.

    Raises:
        InputError: an unknown name, or a value out of its range.
    """
    values: dict[str, float] = {}
    for name, raw in flat.items():
        where = document.where(*path, *name.split("."))
        found = kind(name, where=where)
        if raw == "unknown":
            continue
        if found.parts:
            numbers = document.vector(raw, len(found.parts), *path, *name.split("."))
            spread = {f"{name}.{part}": number for part, number in zip(found.parts, numbers, strict=True)}
        else:
            spread = {name: document.number(raw, *path, *name.split("."))}
        for dotted, number in spread.items():
            _check(dotted, number, found, where)
            values[dotted] = number
    return values


def _check(name: str, number: float, found: Kind, where: str) -> None:
    if found.minimum is None:
        return
    if number < found.minimum or (found.strict and number == found.minimum):
        word = "above" if found.strict else "at least"
        raise InputError(f"{name} must be {word} {found.minimum:g} {found.unit}", given=number, where=where)
    if found.strict and number < SMALLEST:
        raise InputError(f"{name} is out of range", given=number, valid=f"from {SMALLEST:g} {found.unit}", where=where)


def yawing(stated: Mapping[str, float], group: str, called: str = "") -> dict[str, float]:
    """What is stated of a body that moves in the plane: of three moments of inertia the one that it yaws with counts.

    Args:
        stated: by dotted name.
        group: the body's.
        called: what the names begin with instead.
    """
    own = called or group
    out = {f"{own}.{n.split('.', 1)[1]}": v for n, v in stated.items() if n.startswith(f"{group}.")}
    if f"{own}.inertia.z" in out:
        out.setdefault(f"{own}.yaw_inertia", out[f"{own}.inertia.z"])
    return out
