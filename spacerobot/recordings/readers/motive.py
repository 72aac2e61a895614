"""OptiTrack Motive's CSV export: rigid bodies and markers by name, missing frames as empty cells.

Layout (format versions 1.2x): one line of settings in pairs, then one line each for the kind of thing, its
name, its identifier, perhaps its parent, what is measured, and the axis (which starts with "Frame,Time").
Markers of a rigid body may carry the name of a plain marker; then the kind tells them apart
("Rigid Body Marker:NAME.position.x").
"""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import numpy as np

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.base import Reader
from spacerobot.recordings.readers.layout import split
from spacerobot.recordings.readers.numbers import number, reason
from spacerobot.recordings.readers.text import read_lines
from spacerobot.recordings.table import Column, Options, RawTable
from spacerobot.support.errors import InputError

_UNITS = {"meters": "m", "centimeters": "cm", "millimeters": "mm", "inches": "in", "feet": "ft"}
_SETTINGS = "format version"
_LAST_HEADER = 30


class MotiveReader(Reader):
    """Motive's CSV export, with the length unit that its first line states."""

    name: ClassVar[str] = "motive"
    suffixes: ClassVar[tuple[str, ...]] = (".csv",)

    def claims(self, path: Path, head: bytes) -> bool:
        """Motive starts every export with its format version."""
        return head.removeprefix(b"\xef\xbb\xbf").lower().startswith(_SETTINGS.encode())

    def read(self, path: Path, options: Options) -> RawTable:
        """Columns "NAME.position.x", "NAME.rotation.w", "Time" and so on."""
        lines = read_lines(path, options.compression, options.encoding)
        settings = _settings(lines[0]) if lines else {}
        if _SETTINGS not in settings:
            raise InputError("not a Motive export: the first line lacks its format version", where=f"{path}:1")
        axis = next((i for i in range(1, min(len(lines), _LAST_HEADER)) if lines[i].startswith("Frame,")), None)
        if axis is None:
            raise InputError('the header line that starts with "Frame" is missing', where=f"{path}:2")
        names, measured = _columns(path, lines, axis)
        unit = _UNITS.get(settings.get("length units", "").lower())
        rows = [i for i in range(axis + 1, len(lines)) if lines[i].strip()]
        if options.rows is not None:
            rows = rows[options.rows[0] : options.rows[1]]
        if not rows:
            raise InputError("the export has no frames", where=f"{path}:{axis + 1}")
        limits.check_cells(path, len(rows), len(names))
        values = np.full((len(rows), len(names)), np.nan)
        for row, index in enumerate(rows):
            cells = split(lines[index], ",")
            if len(cells) != len(names) and not (len(cells) == len(names) + 1 and not cells[-1]):
                raise InputError(
                    "the row is ragged",
                    given=f"{len(cells)} cells",
                    valid=f"{len(names)} cells",
                    where=f"{path}:{index + 1}",
                )
            for j, cell in enumerate(cells[: len(names)]):
                value = number(cell)
                if value is None:
                    raise InputError(f"{names[j][0]}: {reason(cell)}", given=cell, where=f"{path}:{index + 1}")
                values[row, j] = value
        columns = tuple(
            Column(called, np.ascontiguousarray(values[:, j]), unit if measured[j] == "position" else None)
            for j, called in enumerate(names)
        )
        return RawTable(path, columns, np.asarray(rows, dtype=np.int64) + 1)


def _settings(line: str) -> dict[str, str]:
    cells = split(line.removeprefix("\ufeff"), ",")
    return {cells[i].lower(): cells[i + 1] for i in range(0, len(cells) - 1, 2)}


def _columns(path: Path, lines: list[str], axis: int) -> tuple[list[tuple[str, ...]], list[str]]:
    """The names of each column, and what it measures in lower case ("position", "rotation", ...)."""
    axes = split(lines[axis], ",")
    block = [split(lines[i], ",") for i in range(1, axis) if lines[i].strip(" ,")]
    if len(block) < 3 or any(len(row) > len(axes) for row in block):
        raise InputError(
            "the header is not that of a Motive export",
            valid="lines for kind, name, ID and quantity",
            where=f"{path}:{axis + 1}",
        )
    kinds, things, quantities = ([*row, *[""] * (len(axes) - len(row))] for row in (block[0], block[1], block[-1]))
    names: list[tuple[str, ...]] = []
    for j, letter in enumerate(axes):
        if not things[j] or j < 2:
            names.append((letter or str(j), letter.split(" ")[0] or str(j)))
            continue
        dotted = ".".join(filter(None, (things[j], quantities[j].lower(), letter.lower())))
        names.append((dotted, f"{kinds[j]}:{dotted}"))
    return [tuple(dict.fromkeys(n)) for n in names], [q.lower() for q in quantities]
