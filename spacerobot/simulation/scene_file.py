"""Scenes from files, TOML text and tables; `scene_toml.py` has the format."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_toml import made_from_file, made_from_table, made_from_text


def read_scene(path: str | Path) -> Scene:
    """Read a scene.

    Raises:
        InputError: the file is missing, no TOML, or describes no scene; with file, key, and what is valid.
    """
    return made_from_file(Scene, path)


def scene_from_text(text: str, *, where: str = "scene", folder: Path | None = None) -> Scene:
    """A scene from TOML text; a robot's path is relative to `folder`.

    Raises:
        InputError: no TOML, or it describes no scene.
    """
    return made_from_text(Scene, text, where=where, folder=folder)


def scene_from_table(data: Mapping[str, Any], *, where: str = "scene", folder: Path | None = None) -> Scene:
    """A scene from the tables of a TOML file; a robot's path is relative to `folder`.

    Raises:
        InputError: they describe no scene.
    """
    return made_from_table(Scene, data, where=where, folder=folder)
