"""A scene as a notebook shows it: what it states, each number with its unit."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

from spacerobot.simulation.scene_toml import TABLES
from spacerobot.simulation.scene_units import UNITS
from spacerobot.support.showing import brief

if TYPE_CHECKING:
    from collections.abc import Iterator

_ALWAYS = ("wrist.mass", "wrist.stiffness", "contact.stiffness", "target.mass", "target.speed")
"""Shown whether or not a scene changes them."""


def rows(scene: Any) -> list[tuple[str, Any, str]]:
    """(what, value, unit) of a scene's parts where they are not the default ones, then of its effects."""
    found: list[tuple[str, Any, str]] = [
        ("approach, world axes", brief(scene.approach), "unit vector"),
        ("pose", brief(scene.pose), UNITS["pose"]),
    ]
    for part in TABLES:
        record = getattr(scene, part)
        if record is not None:
            found += [(f"{part}: {_words(k)}", v, UNITS.get(f"{part}.{k}", "")) for k, v in _stated(part, record)]
    if scene.hand_speed:
        found.append(("chaser: hand speed", scene.hand_speed, UNITS["chaser.hand_speed"]))
    if any(scene.gravity):
        found.append(("gravity", brief(scene.gravity), UNITS["gravity"]))
    for item in scene.effects:  # the unit is part of a parameter's name
        values = ", ".join(f"{name} = {brief(value)}" for name, value in item.parameters.items())
        found.append((f"effect: {item.effect} at {item.where}", values, ""))
    return found


def _stated(part: str, record: Any) -> Iterator[tuple[str, Any]]:
    for field in dataclasses.fields(record):
        value = getattr(record, field.name)
        default = field.default if field.default_factory is dataclasses.MISSING else field.default_factory()
        if value is not None and (f"{part}.{field.name}" in _ALWAYS or value != default):
            yield field.name, value if isinstance(value, str | bool | float | int) else brief(value)


def _words(name: str) -> str:
    return name.replace("_", " ")
