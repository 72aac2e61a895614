"""A first study file from a folder of recordings, with what could be guessed and comments on what could not."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from spacerobot.recordings.guess import Guess, find_time, guess, time_unit
from spacerobot.recordings.readers import read_table, reader_for
from spacerobot.recordings.series import estimate_noise
from spacerobot.recordings.table import Options, RawTable
from spacerobot.support.errors import InputError

_SUFFIXES = (
    ".csv", ".tsv", ".txt", ".dat", ".log", ".asc", ".mat", ".h5", ".hdf5", ".npz", ".npy", ".bag", ".mcap", ".db3",
    ".gz", ".bz2", ".xz",
)  # fmt: skip
_MOST_FILES = 2000
_MOST_CHANNELS = 40

_HEAD = """format = 1
draft = true               # diagnose waits until you have read this through and deleted this line
title = {title}

# What you believe about the rig, in SI units. A value left out is unknown and will be fitted.
[baseline]
robot = "pa10_wrist"       # a bundled robot, one of example-robot-data, or a URDF beside this file
base = "fixed"             # or "free"
joints = "locked"          # or "free", "servo"
approach = [1, 0, 0]       # unit vector: the target's direction of motion
gravity = [0, 0, 0]        # along the axes that move; [0, 0, -9.80665] for an arm on a pedestal
# pose_deg = [0, 45, 0, 90, 0, -45, 0]

# [baseline.wrist]
# mass = 0.7
# stiffness = 1000.0
# damping = 2.0
# equivalent_damping = 5.0

# [baseline.contact]
# stiffness = 70000.0

# [baseline.target]
# mass = 20.0              # or for each trial: target.mass = 20.0

# How well you know them: one standard deviation, relative.
# [baseline.sigma]
# "wrist.stiffness" = 0.01
# "target.mass" = 0.002
"""


@dataclass
class _Stream:
    """Files with the same columns.

    Attributes:
        name: the stream's name.
        stem: what the files' names have in common.
        format: name of the reader.
        columns: names of the columns that tell one stream from another.
        table: of the first file.
        files: trial -> file.
    """

    name: str
    stem: str
    format: str
    columns: tuple[str, ...]
    table: RawTable
    files: dict[str, str] = field(default_factory=dict)

    def takes(self, stem: str, format: str, columns: tuple[str, ...], trial: str) -> bool:
        """Whether a file belongs here."""
        same = (stem, format, columns) == (self.stem, self.format, self.columns)
        return same and trial not in self.files


def draft_study(folder: Path) -> str:
    """The text of a first study.toml for the recordings in `folder`.

    Files with the same columns become one stream; parts of a file's name with digits, or its folder, name the
    trial. Columns that cannot be told become `aux.NAME`, which loads and is never balanced.

    Raises:
        InputError: no folder, or no file in it that can be read.
    """
    if not folder.is_dir():
        raise InputError("no such folder", given=str(folder))
    files = sorted(p for p in folder.rglob("*") if _considered(p, folder))
    if len(files) > _MOST_FILES:
        raise InputError("the folder holds too many files", given=len(files), valid=f"at most {_MOST_FILES}")
    streams: list[_Stream] = []
    refused: list[str] = []
    for path in files:
        relative = str(path.relative_to(folder))
        try:
            table = read_table(path, Options(wanted=frozenset()))
            used = frozenset(str(j) for j, c in enumerate(table.columns) if np.isfinite(c.values).mean() > 0.2)
            table = read_table(path, Options(wanted=used))
            format_name = reader_for(path).name
        except InputError as error:
            refused.append(str(error).replace(str(path), relative))
            continue
        if not any(np.isfinite(c.values).sum() > 2 for c in table.columns):
            refused.append(f"{relative}: no columns of numbers")
            continue
        trial, name = _trial_and_stream(path.relative_to(folder))
        columns = table.names() if format_name != "motive" else ()
        stream = next((s for s in streams if s.takes(name, format_name, columns, trial)), None)
        if stream is None:
            stream = _Stream(_unique(name, streams), name, format_name, columns, table)
            streams.append(stream)
        stream.files[trial] = relative
    if not streams:
        listed = "; ".join(refused[:5]) or "it holds none of " + ", ".join(_SUFFIXES)
        raise InputError("the folder holds no recording that can be read", given=str(folder), valid=listed)
    parts = [_HEAD.format(title=_text(folder.resolve().name or "study"))]
    parts += [_stream_text(s) for s in streams]
    parts += _trials_text(streams)
    parts += [f"# not read: {_comment(r)}\n" for r in refused]
    return "\n".join(parts)


def _considered(path: Path, folder: Path) -> bool:
    if any(part.startswith(".") for part in path.relative_to(folder).parts) or path.is_symlink():
        return False
    try:
        str(path).encode("utf-8")  # a study is UTF-8, and could not name the file otherwise
    except UnicodeEncodeError:
        return False
    return path.is_file() and path.name.lower().endswith(_SUFFIXES)


def _trial_and_stream(relative: Path) -> tuple[str, str]:
    """Trial and stream by the file's name: parts with digits name the trial, the others the stream."""
    stem = re.sub(
        r"(\.(csv|tsv|txt|dat|log|asc|gz|bz2|xz|mat|h5|hdf5|npz|npy|bag|mcap|db3))+$", "", relative.name, flags=re.I
    )
    tokens = [t for t in re.split(r"[_\-\s.,+=()]+", stem) if t]
    numbered = [t for t in tokens if any(c.isdigit() for c in t)]
    plain = [t for t in tokens if t not in numbered]
    folders = [re.sub(r"[^\w.+=-]+", "_", part) for part in relative.parts[:-1]]
    trial = "_".join([*folders, *numbered]) or stem
    name = "_".join(plain) if (plain and (numbered or folders)) else "log"
    trial = re.sub(r"[^\w.+=-]+", "_", trial).strip("._ ") or "01"
    return trial[:60], re.sub(r"[^\w-]+", "_", name)[:30].lower() or "log"


def _unique(name: str, streams: list[_Stream]) -> str:
    taken = {s.name for s in streams}
    reserved = {"id", "condition", "pose", "pose_deg", "window", "each", "wrist", "contact", "target", "body", "hand",
                "platform", "joint", "link"}  # fmt: skip
    if name in reserved:
        name = f"{name}_log"
    candidates = [name, *(f"{name}_{i}" for i in range(2, len(taken) + 3))]
    return next(c for c in candidates if c not in taken)


def _stream_text(stream: _Stream) -> str:
    table, names = stream.table, stream.table.names()
    clock = find_time(table)
    lines = [f"[streams.{stream.name}]"]
    if stream.format not in ("csv", "text"):
        lines.append(f'format = "{stream.format}"')
    if clock is None:
        lines.append("rate = 100.0               # Hz: no column looked like a clock, so please say")
    else:
        step = float(np.median(np.diff(table.columns[clock].values)))
        unit = time_unit(table.columns[clock])
        scale = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}[unit]
        lines.append(f"time = {_text(names[clock])}{f'   # about {scale / step:.4g} Hz' if step > 0 else ''}")
        if unit != "s":
            lines.append(f'time_unit = "{unit}"')
    lines.append(f"[streams.{stream.name}.channels]")
    length = len(table.columns[clock].values) if clock is not None else None
    taken: set[str] = set()
    written = 0
    for index, column in enumerate(table.columns):
        enough = np.isfinite(column.values).sum() > 2 and (length is None or len(column.values) == length)
        if index == clock or not enough:
            continue
        written += 1
        if written > _MOST_CHANNELS:
            lines.append(
                f"# and {len(table.columns) - index} columns more: {_comment(', '.join(names[index : index + 30]))}"
            )
            break
        lines.append(_channel_text(guess(names[index], column.unit), estimate_noise(column.values), taken))
    return "\n".join(lines) + "\n"


def _channel_text(found: Guess, noise: float, taken: set[str]) -> str:
    channel = found.channel
    if channel in taken:
        channel = f"aux.{re.sub(r'[^A-Za-z0-9_-]+', '_', found.column).strip('_') or 'column'}"
    while channel in taken:
        channel += "_"
    taken.add(channel)
    unit = f', unit = "{found.unit}"' if found.unit else ""
    remark = f"   # noise about {noise:.2g} as read: sigma = ?" if noise > 0 else ""
    return f'{_text(found.column)} = {{ is = "{channel}"{unit} }}{remark}'


def _trials_text(streams: list[_Stream]) -> list[str]:
    trials = sorted({trial for stream in streams for trial in stream.files})
    found: list[str] = []
    for trial in trials:
        lines = ["[[trials]]", f"id = {_text(trial)}", "# target.mass = "]
        lines += [f"{s.name} = {_text(s.files[trial])}" for s in streams if trial in s.files]
        found.append("\n".join(lines) + "\n")
    return found


def _text(value: str) -> str:
    """A TOML string."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _comment(value: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in value)[:400]
