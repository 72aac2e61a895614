"""What each plain key of study.toml may hold, as rules of JSON Schema with the units in words.

Which keys there are the readers' own tables say (`study_schema.py`); a key of theirs without a rule here cannot be
printed, and a rule without a key fails its test.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from spacerobot.effects.filters import KINDS, ORDERS
from spacerobot.recordings import baseline, stream
from spacerobot.recordings.channel import _PATTERNS, FRAMES, MOMENTS, USES
from spacerobot.recordings.units import UNITS

Rule = dict[str, Any]

CELL: Rule = {"type": "string", "pattern": r"\{[^{}]+\}", "description": "a cell of the trial's `index`"}


def number(words: str, **more: Any) -> Rule:
    """A number, described with its unit."""
    return {"type": "number", "description": words, **more}


def numbers(words: str, count: int | None = None, **of: Any) -> Rule:
    """A list of numbers, described with their unit."""
    sizes = {} if count is None else {"minItems": count, "maxItems": count}
    return {"type": "array", "items": {"type": "number", **of}, "description": words, **sizes}


def text(words: str, **more: Any) -> Rule:
    """A text."""
    return {"type": "string", "description": words, **more}


def choice(words: str, known: Iterable[str]) -> Rule:
    """One of some words."""
    return {"enum": list(known), "description": words}


def flag(words: str) -> Rule:
    """True or false."""
    return {"type": "boolean", "description": words}


def names(words: str) -> Rule:
    """A list of texts."""
    return {"type": "array", "items": {"type": "string"}, "description": words}


def whole(words: str, least: int) -> Rule:
    """A whole number."""
    return {"type": "integer", "minimum": least, "description": words}


def column(words: str) -> Rule:
    """A column by its name or its index."""
    either = [{"type": "string", "minLength": 1}, {"type": "integer", "minimum": 0}]
    return {"anyOf": either, "description": f"{words}: its name, or its index from 0"}


ROWS: Rule = {
    "type": "array",
    "items": {"type": "integer", "minimum": 0},
    "minItems": 1,
    "maxItems": 2,
    "description": "[a, b]: data rows a to b - 1, counted from 0; b may be left out",
}
MISSING: Rule = {
    "anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}}],
    "description": 'raw readings that mean "no reading" [unit of the column]',
}
POSE = "joint positions from base to tip"
EXACT = names("dotted names of values that are held as they are stated")

TOP: dict[str, Rule] = {
    "draft": flag("the study is not finished: `diagnose` asks for what it lacks until this line is gone"),
    "title": text("one line"),
    "data": text('folder of the files, where it is not the study\'s own: "${SPACEROBOT_DATA}/..." or one beneath it'),
    "exact": EXACT,
    "horizon": number("how long a simulation runs before it begins anew from the recording [s]", exclusiveMinimum=0),
}
"""Those without a table of their own."""

BASELINE: dict[str, Rule] = {
    "robot": text("bundled name, name of example-robot-data, or a URDF inside the study's folder or its data's"),
    "base": choice("what the robot stands on", baseline.BASES),
    "joints": choice("what the robot's joints do", baseline.JOINTS),
    "pose": numbers(f"{POSE} [rad, or m of joints that slide]"),
    "pose_deg": numbers(f"{POSE} [degrees]"),
    "approach": numbers("unit vector, world axes: the target's direction of motion [1]", 3),
    "gravity": numbers("acceleration, world axes [m/s^2]", 3),
    "exact": EXACT,
}

GEARS: dict[str, Rule] = {
    "streams": names("streams that log motors"),
    "joints": names("joints that they turn, in the order of the ratio"),
    "ratio": {
        "type": "array",
        "items": {"anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}}]},
        "description": "turns of each motor per turn of its joint, or a row for each motor with those per joint [1]",
    },
    "torque_per_ampere": {
        "anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}}],
        "description": "of every motor, or of each: currents become torques [N m/A]",
    },
}

STREAM: dict[str, Rule] = {
    "time": column("column with the times"),
    "time_unit": choice("unit of the times; s if absent", (n for n, u in UNITS.items() if u.dimension == "time")),
    "time_offset": number("added to the times [s]"),
    "rate": number("samples per second where the file has no times [Hz]", exclusiveMinimum=0),
    "format": choice("found out if absent", stream.FORMATS),
    "variable": text(
        "array of a MAT, HDF5 or npz file, its struct or group, topic of a bag, sheet of a workbook, table of an export"
    ),
    "separator": choice("between cells, found out if absent", (*stream.SEPARATORS, *stream.SEPARATORS.values())),
    "decimal": choice("found out if absent", (".", ",")),
    "header_rows": whole("lines before the data, found out if absent [1]", 0),
    "rows": ROWS,
    "reshape": whole("number of interleaved values a row [1]", 1),
    "compression": choice("found out if absent", stream.COMPRESSIONS),
    "clock": text('name shared with other streams; "own": its offset is unknown and fitted trial by trial'),
    "kind": choice("samples over time, or rows of before and after", stream.KINDS),
    "missing": MISSING,
    "repeated": choice("what becomes of rows that repeat the row before", stream.REPEATED),
    "sort": flag("sort by time, instead of refusing a clock that runs backwards"),
    "encoding": choice("found out if absent", stream.ENCODINGS),
}
"""Those of [streams.NAME] but for its channels."""

CHANNEL: dict[str, Rule] = {
    "is": text("the channel", pattern=f"^(?:{'|'.join(pattern for pattern, _ in _PATTERNS)})$"),
    "sigma": number("one standard deviation of the sensor's noise [the channel's `unit`]", exclusiveMinimum=0),
    "unit": choice("of scale * reading + offset; SI, or what the file says, if absent", UNITS),
    "scale": number("factor on the reading [1]"),
    "offset": number("added after the scale [the channel's `unit`]"),
    "offset_sigma": number("one standard deviation of where its zero is [the channel's `unit`]", minimum=0),
    "use": choice("measured, or commanded and known", USES),
    "missing": MISSING,
    "moment": choice('of a stream of kind "events": when it was taken', MOMENTS),
    "unwrap": flag("take jumps of a turn out of an angle"),
    "plus": {
        "type": "object",
        "additionalProperties": {"anyOf": [{"type": "number"}, numbers("[factor, its standard deviation] [1]", 2)]},
        "description": "other columns that are added, each with its factor, or [factor, standard deviation] [1]",
    },
    "frame": choice("axes of a force: the world's, or those of the body that it acts on", FRAMES),
    "filter": {
        "type": "object",
        "properties": {
            "cutoff": number("where its gain is 3 dB down [Hz]", exclusiveMinimum=0),
            "order": {"enum": list(ORDERS), "description": "1 if absent [1]"},
            "kind": choice(f"{KINDS[0]} if absent", KINDS),
        },
        "required": ["cutoff"],
        "additionalProperties": False,
        "description": "the low-pass filter that the sensor of a wrist rig is known to have",
    },
}

TRIAL: dict[str, Rule] = {
    "id": {
        "anyOf": [text("", pattern=r"^[\w.+=, {}:-]{1,80}$"), {"type": "integer"}],
        "description": "the trial's name; {n} stands for the number of `each`, {COLUMN} for a cell of `index`",
    },
    "condition": {
        "type": ["string", "number"],
        "description": "what it shares with its like; its target's mass if absent",
    },
    "pose": numbers(f"{POSE} [rad, or m of joints that slide]"),
    "pose_deg": numbers(f"{POSE} [degrees]"),
    "window": numbers("first and last time that count, as recorded [s]", 2),
    "step": number("what `each` moves the window on by, from one to the next [s]"),
    "each": {
        "type": "array",
        "items": {"type": "integer", "minimum": 0},
        "minItems": 2,
        "maxItems": 2,
        "description": "[first, last]: a trial for each number",
    },
    "offset": {
        "type": "object",
        "description": "channel -> offset of this trial alone [the channel's `unit`]",
    },
    "index": text("the lab's own list of its runs: a trial for each row"),
}

SOURCE: dict[str, Rule] = {
    "file": text("path inside the data's folder", minLength=1),
    "variable": text("array in the file, in place of the stream's"),
    "rows": ROWS,
    "time_file": text("file that holds the times, one a row"),
}
