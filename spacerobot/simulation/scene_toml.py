"""Scenes as TOML files, format 1; names are those of a study's baseline where the two coincide.

    format = 1
    robot = "pa10_wrist"        # bundled name, example robot, or a URDF path relative to the file
    base = "fixed"              # or "free"
    joints = "locked"           # "free" or "servo"
    pose_deg = [0, 45, 0, 90, 0, -45, 0]
    approach = [1, 0, 0]
    [wrist]
    stiffness = 530
    [target]
    mass = 9.0
    speed = 0.07
    [[effects]]
    effect = "coulomb_friction"
    where = "wrist"
    parameters = { force_N = 0.4 }

Tables: wrist, contact, target, servo, motion, chaser (hand_speed), spacecraft, others (JOINT = position), [[effects]].
Keys are the fields of `Wrist`,
`ContactLaw`, `Target`, `Servo`, `Motion` and `SpacecraftSpec`.
"""

from __future__ import annotations

import dataclasses
import json
import math
import tomllib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from spacerobot.model.spacecraft import SpacecraftSpec
from spacerobot.simulation.parts import ContactLaw, EffectAt, Motion, Servo, Target, Wrist
from spacerobot.simulation.parts.checks import number, vector
from spacerobot.support.errors import InputError, NotFoundError
from spacerobot.support.files import read_toml_text
from spacerobot.support.formats import require_format

T = TypeVar("T")

FORMAT = 1
MAX_BYTES = 1_000_000
TABLES: dict[str, type] = {
    "wrist": Wrist,
    "contact": ContactLaw,
    "target": Target,
    "servo": Servo,
    "motion": Motion,
    "spacecraft": SpacecraftSpec,
}
"""Parts of a scene that have a table of their own."""

_PLAIN = ("robot", "base", "joints", "tip", "approach", "gravity", "duration", "backend", "title")
_TOP = ("format", *_PLAIN, "pose", "pose_deg", "others", "chaser", "effects", *TABLES)


def made_from_file(make: Callable[..., T], path: str | Path) -> T:
    """What `make` makes of a scene's file.

    Raises:
        InputError: the file is missing, no TOML, or describes no scene; with file, key, and what is valid.
    """
    text = read_toml_text(path, "scene", MAX_BYTES)
    return made_from_text(make, text, where=str(path), folder=Path(path).resolve().parent)


def made_from_text(make: Callable[..., T], text: str, *, where: str, folder: Path | None) -> T:
    """What `make` makes of TOML text; a robot's path is relative to `folder`.

    Raises:
        InputError: no TOML, or it describes no scene.
    """
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"not TOML: {error}", where=where) from None
    return made_from_table(make, data, where=where, folder=folder)


def made_from_table(make: Callable[..., T], data: Mapping[str, Any], *, where: str, folder: Path | None) -> T:
    """What `make` makes of the tables of a TOML file; a robot's path is relative to `folder`.

    Raises:
        InputError: they describe no scene.
    """
    try:
        return make(**_fields(data, folder))
    except NotFoundError as error:
        place = f"{where}: {error.where}" if error.where else where
        raise NotFoundError(error.kind, error.name, error.known, where=place) from None
    except InputError as error:
        place = f"{where}: {error.where}" if error.where else where
        raise InputError(error.what, given=error.given, valid=error.valid, where=place) from None


def _fields(data: Mapping[str, Any], folder: Path | None) -> dict[str, Any]:
    """A scene's fields, by name."""
    require_format(data.get("format", FORMAT), FORMAT, "scene", "format")
    _known(data, _TOP, "")
    given: dict[str, Any] = {key: data[key] for key in _PLAIN if key in data}
    for key in ("robot", "base", "joints", "tip", "backend", "title"):
        if key in given and not isinstance(given[key], str):
            raise InputError("must be text", given=given[key], where=key)
    if "robot" in given:
        given["robot"] = _robot(given["robot"], folder)
    if "pose" in data and "pose_deg" in data:
        raise InputError("pose and pose_deg are both given", valid="one of them", where="pose_deg")
    if "pose_deg" in data:
        degrees = vector(data["pose_deg"], tuple(range(64)), "pose_deg", "joint positions in degrees")
        given["pose"] = tuple(math.radians(d) for d in degrees)
    elif "pose" in data:
        given["pose"] = vector(data["pose"], tuple(range(64)), "pose", "joint positions in rad")
    for name, kind in TABLES.items():
        if name in data:
            table = _table(data, name)
            _known(table, [f.name for f in dataclasses.fields(kind)], name)
            given[name] = kind(**table)
    if "chaser" in data:
        table = _table(data, "chaser")
        _known(table, ("hand_speed",), "chaser")
        given["hand_speed"] = number(table.get("hand_speed", 0.0), "chaser.hand_speed")
    if "others" in data:
        given["others"] = {k: number(v, f"others.{k}") for k, v in _table(data, "others").items()}
    given["effects"] = _effects(data.get("effects", []))
    return given


def _robot(name: str, folder: Path | None) -> str | Path:
    if name.lstrip().startswith("<"):
        raise InputError("a scene names its robot", given=name, valid="a name or a URDF path", where="robot")
    path_like = "/" in name or "\\" in name or name.lower().endswith((".urdf", ".xml"))
    if "\0" in name or not name.strip():
        raise InputError("must be a name or a URDF path", given=name, where="robot")
    return (folder / name) if path_like and folder is not None else name


def _effects(tables: Any) -> tuple[EffectAt, ...]:
    if not isinstance(tables, list) or not all(isinstance(t, dict) for t in tables):
        raise InputError("effects must be written as [[effects]]", given=tables, where="effects")
    found = []
    for i, table in enumerate(tables):
        where = f"effects[{i}]"
        _known(table, ("effect", "where", "parameters"), where)
        for key in ("effect", "where"):
            if not isinstance(table.get(key), str):
                raise InputError(f"needs {key} = NAME", given=table.get(key), where=where)
        parameters = table.get("parameters", {})
        if not isinstance(parameters, dict):
            raise InputError("parameters must be a table", given=parameters, where=where)
        values: dict[str, float | str] = {}
        for name, value in parameters.items():
            if isinstance(value, str):  # which of an effect's forms is meant; the effect refuses what names none
                values[name] = value
                continue
            infinite = isinstance(value, float) and math.isinf(value)  # a null value may be infinite
            values[name] = value if infinite else number(value, f"{where}.{name}")
        found.append(EffectAt(table["effect"], table["where"], values))
    return tuple(found)


def _table(data: Mapping[str, Any], name: str) -> dict[str, Any]:
    table = data[name]
    if not isinstance(table, dict):
        raise InputError(f"{name} must be a table", given=table, valid=f"[{name}]", where=name)
    return table


def _known(table: Mapping[str, Any], known: Iterable[str], where: str) -> None:
    for key in table:
        if key not in known:
            raise NotFoundError("key", key, known, where=where or None)


def text_of(scene: Mapping[str, Any]) -> str:
    """TOML text that `made_from_text` reads back, of a scene's fields by name."""
    top: dict[str, Any] = {
        "format": FORMAT,
        "title": scene["title"],
        "robot": scene["robot"],
        "base": scene["base"],
        "joints": scene["joints"],
        "pose": scene["pose"],
        "tip": scene["tip"],
        "approach": scene["approach"],
        "gravity": scene["gravity"],
        "duration": scene["duration"],
        "backend": scene["backend"],
    }
    lines = [f"{key} = {_value(value)}" for key, value in top.items() if value not in (None, "")]
    tables: dict[str, Any] = {name: scene[name] for name in TABLES}
    for name, record in tables.items():
        if record is not None and record != Motion():
            lines += ["", f"[{name}]"]
            values = {f.name: getattr(record, f.name) for f in dataclasses.fields(record)}
            lines += [f"{key} = {_value(value)}" for key, value in values.items() if value not in (None, {})]
    if scene["others"]:
        lines += ["", "[others]", *(f"{json.dumps(k)} = {_value(v)}" for k, v in scene["others"].items())]
    if scene["hand_speed"]:
        lines += ["", "[chaser]", f"hand_speed = {_value(scene['hand_speed'])}"]
    for item in scene["effects"]:
        inline = ", ".join(f"{key} = {_value(v)}" for key, v in item.parameters.items())
        lines += ["", "[[effects]]", f"effect = {_value(item.effect)}", f"where = {_value(item.where)}"]
        lines.append(f"parameters = {{ {inline} }}")
    return "\n".join(lines) + "\n"


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, int | np.integer):
        return str(int(value))
    if isinstance(value, float | np.floating):
        return repr(float(value))
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{json.dumps(k)} = {_value(v)}" for k, v in value.items()) + " }"
    return "[" + ", ".join(_value(v) for v in value) + "]"
