"""Vicon's CSV export (Nexus, Tracker): tables one beneath the other, each at its own rate, on one clock.

Layout of each: a line with its name ("Devices", "Trajectories", "Objects"), one with its rate [Hz], one with the things
above the first of their columns, one that begins with "Frame,Sub Frame", one of units, the rows, and a blank line.
Frames count from 1 at the cameras' rate; a device of ten times that rate has sub-frames 0 to 9.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.base import Reader
from spacerobot.recordings.readers.delimited import numbers_of
from spacerobot.recordings.readers.layout import Layout, split
from spacerobot.recordings.readers.numbers import number
from spacerobot.recordings.readers.text import read_lines
from spacerobot.recordings.table import Column, Options, RawTable
from spacerobot.recordings.units import UNITS
from spacerobot.support.errors import InputError

_BEGINS = re.compile(rb"(?:\xef\xbb\xbf)?\"?[a-z][a-z ]*\"?,*\r?\n\"?[0-9.]+\"?,*\r?\n,", re.I)
_QUANTITIES = re.compile(rb"\n\"?frame\"?,\"?sub ?frame\"?,", re.I)
_LONGEST = 1 << 18
"""Bytes in which the names of all markers end."""

_AXES = {
    "x": "position.x",
    "y": "position.y",
    "z": "position.z",
    "tx": "position.x",
    "ty": "position.y",
    "tz": "position.z",
}
_TURNS = {"rx": "rotation.x", "ry": "rotation.y", "rz": "rotation.z", "rw": "rotation.w"}
_HEADER = 5


@dataclass(frozen=True)
class _Table:
    """Where a table stands.

    Attributes:
        name: its title.
        rate: rows a second [Hz].
        first: index of its title's line.
        rows: indices of its rows.
    """

    name: str
    rate: float
    first: int
    rows: range


class NexusReader(Reader):
    """One of the export's tables; `variable` names it. Its column "time" counts seconds from frame 1 on."""

    name: ClassVar[str] = "nexus"
    suffixes: ClassVar[tuple[str, ...]] = (".csv",)

    def claims(self, path: Path, head: bytes) -> bool:
        """A title, a rate, things, and "Frame,Sub Frame", after a line that may be longer than the head."""
        return bool(_BEGINS.match(head) and _QUANTITIES.search(limits.read_head(path, _LONGEST)))

    def parts(self, path: Path) -> tuple[str, ...]:
        """The tables' names."""
        return tuple(t.name for t in _tables(path, read_lines(path, None, None)))

    def read(self, path: Path, options: Options) -> RawTable:
        """Columns "time", "Frame", "NAME.position.x", "DEVICE.Fx" and so on."""
        lines = read_lines(path, options.compression, options.encoding)
        tables = _tables(path, lines)
        table = next((t for t in tables if options.variable in (None, t.name)), None)
        if table is None:
            raise InputError(
                "the file has no such table",
                given=str(options.variable),
                valid=", ".join(t.name for t in tables),
                where=str(path),
            )
        rows: Sequence[int] = table.rows
        if options.rows is not None:
            rows = rows[options.rows[0] : options.rows[1]]
        if not rows:
            raise InputError("the table has no rows", given=table.name, where=f"{path}:{table.first + 1}")
        names, units = _columns([split(lines[table.first + k], ",") for k in range(2, _HEADER)])
        limits.check_cells(path, len(rows), len(names))
        layout = Layout(",", ".", (), rows, len(names), (True,) * len(names))
        values = numbers_of(path, lines, rows, layout, len(names), _wanted(names, options))
        per_frame = _per_frame(lines, table.rows)
        time = Column(("time",), ((values[:, 0] - 1.0) * per_frame + values[:, 1]) / table.rate, "s")
        columns = (Column(n, np.ascontiguousarray(values[:, j]), units[j]) for j, n in enumerate(names))
        several = options.variable is None and len(tables) > 1
        notes = (f"the first of {len(tables)} tables, {table.name!r}, is read",) if several else ()
        return RawTable(path, (time, *columns), np.asarray(rows, dtype=np.int64) + 1, notes)


def _wanted(names: Sequence[tuple[str, ...]], options: Options) -> set[int] | None:
    """The columns that must hold numbers; indices count the column of times before them."""
    if options.wanted is None:
        return None
    return {0, 1, *(j for j, called in enumerate(names) if options.wanted & {*called, str(j + 1)})}


def _per_frame(lines: Sequence[str], rows: Sequence[int]) -> float:
    """Rows a frame, by the sub-frames of the first whole one."""
    most, frames = 0.0, set[str]()
    for index in rows:
        frame, sub, *_ = (*split(lines[index], ",")[:2], "", "")
        frames.add(frame)
        if len(frames) > 2:
            break
        most = max(most, number(sub) or 0.0)
    return 1.0 + most


def _tables(path: Path, lines: Sequence[str]) -> list[_Table]:
    """The export's tables, each up to the next blank line.

    Raises:
        InputError: something else stands where a table should begin, or two have one name.
    """
    found: list[_Table] = []
    taken: set[str] = set()
    at = 0
    while at < len(lines):
        if not lines[at].strip(" ,"):
            at += 1
            continue
        begin = at + _HEADER
        rows = next((i for i in range(begin, len(lines)) if lines[i].strip(" ,")), begin)
        if rows < len(lines) and number(split(lines[rows], ",")[0]) is not None:
            begin = rows  # some versions leave a line empty above them
        end = next((i for i in range(begin, len(lines)) if not lines[i].strip(" ,")), len(lines))
        title = split(lines[at].removeprefix("\ufeff"), ",")[0]
        rate = number(split(lines[at + 1], ",")[0]) if begin <= len(lines) else None
        if rate is None or not rate > 0.0 or not lines[at + 3].strip('"').lower().startswith("frame"):
            raise InputError(
                "not a table of such an export",
                given=title[:60],
                valid='lines with its name, its rate, its things, "Frame,Sub Frame,..." and the units',
                where=f"{path}:{at + 1}",
            )
        if title in taken:
            raise InputError("two tables have the same name", given=title[:60], where=f"{path}:{at + 1}")
        taken.add(title)
        found.append(_Table(title, rate, at, range(begin, end)))
        at = end
    return found


def _columns(head: Sequence[Sequence[str]]) -> tuple[list[tuple[str, ...]], list[str | None]]:
    """The columns' names and units, from the lines of things, of quantities and of units."""
    width = len(head[1])
    while width > 2 and not head[1][width - 1]:
        width -= 1
    things, quantities, stated = ([*row, *[""] * width][:width] for row in head)
    names: list[tuple[str, ...]] = []
    thing = ""
    for above, what in zip(things, quantities, strict=True):
        thing = above or thing
        known = _AXES.get(what.lower()) or _TURNS.get(what.lower())
        names.append((f"{thing}.{known or what}",) if thing else (what,))
    return names, [u if u in UNITS else None for u in stated]
