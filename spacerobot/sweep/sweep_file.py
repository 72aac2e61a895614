"""Sweeps as TOML files, format 1; see docs/sweep.md."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot.simulation.parts.checks import number, vector
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_file import read_scene, scene_from_table
from spacerobot.support.errors import InputError, NotFoundError
from spacerobot.support.files import read_toml_text
from spacerobot.support.formats import require_format
from spacerobot.sweep.keys import known
from spacerobot.sweep.plan import MOST, Plan
from spacerobot.sweep.scatter import KINDS, Scatter

FORMAT = 1
MAX_BYTES = 10_000_000
MOST_VALUES, MOST_POSES = 1_000_000, 1_000_000
MOST_ROWS = 2_000_000
_TOP = ("format", "title", "scene", "poses", "grid", "scatter", "repeats", "seed", "rows_per_part")


def read_sweep(path: str | Path) -> str:
    """Text of a sweep file.

    Raises:
        InputError: it is missing, too large or no text.
    """
    return read_toml_text(path, "sweep", MAX_BYTES)


def plan_from_text(text: str, folder: Path, *, seed: int | None = None, where: str = "sweep") -> Plan:
    """The plan that a sweep file describes.

    Args:
        text: TOML.
        folder: paths in it are relative to this.
        seed: instead of the file's.
        where: the file's name, for messages.

    Raises:
        InputError: no TOML, or it describes no sweep; with file, key, and what is valid.
    """
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"not TOML: {error}", where=where) from None
    try:
        return _plan(data, folder, seed)
    except NotFoundError as error:
        raise NotFoundError(error.kind, error.name, error.known, where=_place(where, error.where)) from None
    except InputError as error:
        raise InputError(error.what, given=error.given, valid=error.valid, where=_place(where, error.where)) from None


def _place(where: str, inner: str | None) -> str:
    return f"{where}: {inner}" if inner else where


def _plan(data: Mapping[str, Any], folder: Path, seed: int | None) -> Plan:
    require_format(data.get("format", FORMAT), FORMAT, "sweep", "format")
    _known(data, _TOP, None)
    if not isinstance(data.get("title", ""), str):
        raise InputError("must be text", given=data["title"], where="title")
    scene = _scene(data.get("scene", {}), folder)
    seed = _whole(data.get("seed", 0), "seed", 0, 2**62) if seed is None else seed
    grid = {known(k, "grid"): _values(v, f"grid.{k}") for k, v in _flat(data.get("grid", {}), "grid").items()}
    scatter = {
        known(k, "scatter"): _scatter(v, f"scatter.{k}") for k, v in _flat(data.get("scatter", {}), "scatter").items()
    }
    return Plan(
        scene,
        _poses(data.get("poses", {}), scene, seed),
        grid,
        scatter,
        repeats=_whole(data.get("repeats", 1), "repeats", 1, MOST),
        seed=seed,
        rows=_whole(data.get("rows_per_part", 100_000), "rows_per_part", 1, MOST_ROWS),
        title=data.get("title", ""),
    )


def _scene(given: Any, folder: Path) -> Scene:
    if isinstance(given, str):
        return read_scene(folder / given)
    if not isinstance(given, dict):
        raise InputError("must be a table, or the path of a scene file", given=given, where="scene")
    return scene_from_table({"backend": "reduced", **given}, where="scene", folder=folder)


def _poses(given: Any, scene: Scene, seed: int) -> tuple[tuple[float, ...], ...]:
    if not isinstance(given, dict):
        raise InputError("must be a table", given=given, valid="[poses]", where="poses")
    _known(given, ("list", "list_deg", "count", "spread_deg"), "poses")
    own = tuple(scene.pose or ())
    lists = [name for name in ("list", "list_deg") if name in given]
    if len(lists) == 2 or (lists and "count" in given):
        raise InputError("poses are given twice", given=sorted(given), valid="a list, or count and spread_deg")
    if lists:
        rows = given[lists[0]]
        if not isinstance(rows, list) or not 1 <= len(rows) <= MOST_POSES:
            raise InputError("must be a list of poses", given=rows, where=f"poses.{lists[0]}")
        each = [
            vector(r, len(own), f"poses.{lists[0]}[{i}]", f"{len(own)} joint positions") for i, r in enumerate(rows)
        ]
        return tuple(tuple(math.radians(v) for v in r) if lists[0] == "list_deg" else r for r in each)
    if "spread_deg" in given and "count" not in given:
        raise InputError("a spread needs a count", valid="poses.count", where="poses.spread_deg")
    if "count" not in given:
        return (own,)
    count = _whole(given["count"], "poses.count", 1, MOST_POSES)
    spread = math.radians(number(given.get("spread_deg", 10.0), "poses.spread_deg", minimum=0.0))
    draws = np.random.Generator(np.random.Philox(key=[seed, 1])).uniform(-spread, spread, (count, len(own)))
    low, high = _limits(scene)
    return tuple(tuple(p) for p in np.clip(np.array(own) + draws, low, high).tolist())


def _limits(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Of the chain's joints; none for a joint without them."""
    robot = scene.prepared
    low, high = [], []
    for name in robot.chain:
        joint = robot.model.joints[robot.joint_id(name)]
        bounds = robot.model.lowerPositionLimit[joint.idx_q], robot.model.upperPositionLimit[joint.idx_q]
        bounded = joint.nq == 1 and bounds[0] < bounds[1]
        low.append(bounds[0] if bounded else -math.inf)
        high.append(bounds[1] if bounded else math.inf)
    return np.array(low), np.array(high)


def _flat(given: Any, where: str) -> dict[str, Any]:
    """Dotted key -> its specification, whether the file quotes the dots or not."""
    if not isinstance(given, dict):
        raise InputError("must be a table", given=given, valid=f"[{where}]", where=where)
    found: dict[str, Any] = {}
    for key, value in given.items():
        inner = isinstance(value, dict) and "." not in key
        for name, item in ({f"{key}.{k}": v for k, v in value.items()} if inner else {key: value}).items():
            if name in found:
                raise InputError("given twice", given=name, where=where)
            found[name] = item
    return found


def _values(given: Any, where: str) -> tuple[float, ...]:
    if isinstance(given, dict):
        _known(given, ("from", "to", "count", "log"), where)
        for name in ("from", "to", "count"):
            if name not in given:
                raise InputError(f"lacks {name}", given=given, valid="{ from = 1.0, to = 2.0, count = 5 }", where=where)
        log = given.get("log", False)
        if not isinstance(log, bool):
            raise InputError("log must be true or false", given=log, where=where)
        start, stop = (
            number(given[k], f"{where}.{k}", minimum=0.0 if log else None, strict=log) for k in ("from", "to")
        )
        count = _whole(given["count"], f"{where}.count", 1, MOST_VALUES)
        spaced = np.geomspace(start, stop, count) if log else np.linspace(start, stop, count)
        return tuple(spaced.tolist())
    if not isinstance(given, list) or not 1 <= len(given) <= MOST_VALUES:
        raise InputError("must be a list of numbers, or a range", given=given, where=where)
    return tuple(number(v, f"{where}[{i}]") for i, v in enumerate(given))


def _scatter(given: Any, where: str) -> Scatter:
    if not isinstance(given, dict):
        raise InputError("must be a table", given=given, valid="{ normal = 0.05 }", where=where)
    _known(given, (*KINDS, "absolute"), where)
    kinds = [k for k in KINDS if k in given]
    if len(kinds) != 1:
        raise InputError("one kind of scatter is needed", given=given, valid=" or ".join(KINDS), where=where)
    absolute = given.get("absolute", False)
    if not isinstance(absolute, bool):
        raise InputError("absolute must be true or false", given=absolute, where=where)
    return Scatter(kinds[0], number(given[kinds[0]], f"{where}.{kinds[0]}", minimum=0.0), absolute)


def _whole(value: Any, where: str, least: int, most: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise InputError("not a whole number in range", given=value, valid=f"{least} to {most}", where=where)
    return value


def _known(table: Mapping[str, Any], names: Iterable[str], where: str | None) -> None:
    for key in table:
        if key not in names:
            raise NotFoundError("key", str(key), names, where=where)
