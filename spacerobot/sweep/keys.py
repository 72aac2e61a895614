"""Which numbers of a scene a sweep may vary, and how a scene with other numbers is made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace

from spacerobot.simulation.parts import ContactLaw, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.support.errors import NotFoundError

_NO_NUMBERS = ("law", "bilateral")
KEYS = (
    *(f"wrist.{f.name}" for f in fields(Wrist)),
    *(f"contact.{f.name}" for f in fields(ContactLaw) if f.name not in _NO_NUMBERS),
    *(f"target.{name}" for name in ("mass", "speed", "gap", "yaw_inertia")),
    "chaser.hand_speed",
)
"""Dotted as in a scene file."""


def known(key: str, where: str) -> str:
    """The key, if there is one of this name.

    Raises:
        NotFoundError: there is none.
    """
    if key not in KEYS:
        raise NotFoundError("number of a scene", key, KEYS, where=where)
    return key


def value_of(scene: Scene, key: str) -> float | None:
    """The number that a scene has now."""
    table, name = key.split(".")
    if table == "chaser":
        return scene.hand_speed
    found: float | None = getattr(getattr(scene, table), name)
    return found


def with_values(scene: Scene, values: Mapping[str, float], pose: tuple[float, ...] | None = None) -> Scene:
    """The scene with numbers, and its pose [rad or m], replaced.

    Raises:
        InputError: numbers that make no scene.
    """
    changed: dict[str, object] = {}
    for table in ("wrist", "contact", "target"):
        own = {key.split(".")[1]: value for key, value in values.items() if key.startswith(f"{table}.")}
        if own:
            changed[table] = replace(getattr(scene, table), **own)
    if "chaser.hand_speed" in values:
        changed["hand_speed"] = values["chaser.hand_speed"]
    if pose is not None:
        changed["pose"] = pose
    return replace(scene, **changed) if changed else scene  # type: ignore[arg-type]
