"""What a diagnosis found, as a scene: the capture with the missing physics in it, and the believed rig as a ghost."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot.diagnosis.answer.schema import validate
from spacerobot.simulation.scene_file import read_scene
from spacerobot.simulation.simulate import simulate
from spacerobot.support.errors import InputError
from spacerobot.view.report.words import effects_phrase
from spacerobot.view.scene3d.extent import gains_for
from spacerobot.view.scene3d.film import Array, Film
from spacerobot.view.scene3d.target_body import as_ghost
from spacerobot.view.scene3d.trajectory_film import trajectory_film

APART = 1.5e-4
"""Differences are coloured in units of this, a good marker's noise [m]."""

_SAID = {
    "ambiguous": "Several explanations fit; this is the favourite",
    "learned": "A law was learned that no catalogue holds",
    "unknown": "Something is missing that has no name here",
    "nothing_missing": "Nothing is missing that the data could show",
    "wrong_parameter": "A believed value was wrong",
    "not_trusted": "The fit failed its own checks",
}


def verdict_film(path: Path) -> Film:
    """The film of a finished diagnosis.

    Args:
        path: verdict.json; scene.toml lies beside it.

    Raises:
        InputError: it is no verdict, or the diagnosis has no scene (machines other than a wrist and a target).
    """
    verdict = read_verdict(path)
    file = path.parent / "scene.toml"
    if not file.is_file():
        raise InputError("no scene lies beside this verdict", given=str(path), valid="that of a wrist and a target")
    scene = read_scene(file)
    film = trajectory_film(simulate(scene), scene)
    title = f"{verdict['study']}: {said(verdict)}"
    if not scene.effects:
        return replace(film, title=title)
    bare = replace(scene, effects=())
    believed = simulate(bare, duration=float(film.time[-1]) + 1e-3)
    target = next(b for b in film.bodies if b.name == "target")
    other = np.interp(film.time, believed.time, believed["target.x"])
    shown = np.interp(film.time, *_track(film, scene.approach))
    places = target.poses.copy()
    places[:, :3] += np.outer(other - other[0] - (shown - shown[0]), scene.approach)
    apart = np.abs(other - other[0] - (shown - shown[0])) / APART
    ghost = as_ghost(target.pieces, "believed/target", places, target.poses, apart)
    bodies = (*film.bodies, ghost)
    ghost_words = ("without it", f"the same hit without what was found; with σ = {1e3 * APART:g} mm the two agree")
    return replace(film, title=title, bodies=bodies, gains=gains_for(bodies), ghost=ghost_words)


def read_verdict(path: Path) -> Mapping[str, Any]:
    """A verdict from its file, checked against the schema.

    Raises:
        InputError: not JSON, or not a verdict.
    """
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (UnicodeError, ValueError, RecursionError) as error:
        raise InputError(f"not JSON: {error}", where=str(path)) from None
    if not isinstance(found, dict):
        raise InputError("not a verdict", given=type(found).__name__, where=str(path))
    validate(found, str(path))
    return found


def said(verdict: Mapping[str, Any]) -> str:
    """The verdict in a few words."""
    if verdict["verdict"] == "named":
        return f"found {effects_phrase(verdict['effects'])}"
    return _SAID[verdict["verdict"]].lower()


def _track(film: Film, approach: tuple[float, ...]) -> tuple[Array, Array]:
    target = next(b for b in film.bodies if b.name == "target")
    return film.time, target.poses[:, :3] @ np.array(approach)
