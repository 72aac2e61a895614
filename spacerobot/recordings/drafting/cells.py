"""Files that hold several trials: a cell array of matrices, one a trial."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import PurePath

import numpy as np

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.names import named, without_ending
from spacerobot.recordings.guess import runs_forward
from spacerobot.recordings.table import Column, RawTable

_IN_CELL = re.compile(r"(?P<cell>[^\[\]]+)\[(?P<place>\d+)\]\[(?:\d+|\d+,:)\]")
"""A column or a row of a matrix in a cell, as `readers.arrays` calls them."""


def trials_in(file: Found) -> list[Found]:
    """The file's matrices as files of their own, where it holds several that are alike; else the file.

    Their columns go by place, since their names differ from trial to trial; a clock in a cell beside gives their rate.
    """
    cells: dict[tuple[str, int], list[Column]] = {}
    for column in file.table.columns:
        inside = _IN_CELL.fullmatch(column.names[0]) if column.names else None
        if inside is not None:
            cells.setdefault((inside["cell"], int(inside["place"])), []).append(column)
    if len(cells) < 2 or len({len(own) for own in cells.values()}) > 1:
        return [file]
    counts = [sum(cell == other for other, _ in cells) for cell in dict.fromkeys(cell for cell, _ in cells)]
    beside = len(set(counts)) == 1  # as many forces as positions; else further trials of the same
    stem = without_ending(PurePath(file.relative).name)
    found = []
    for n, ((cell, place), own) in enumerate(cells.items()):
        columns = tuple(Column((), c.values, c.unit) for c in own)
        trial = replace(
            file,
            table=RawTable(file.table.path, columns, None, file.table.notes),
            usable=tuple(range(len(columns))),
            named=named(PurePath(file.relative).with_name(f"{stem}_{cell}_{place}" if beside else f"{stem}_{n}")),
            variable=f"{cell}[{place}]",
            rate=_rate(file, len(own[0].values), place),
        )
        found.append(trial)
    return found


def _rate(file: Found, rows: int, place: int) -> float | None:
    """Readings a second [Hz] by a clock of this length in a cell of the same place."""
    for column in file.table.columns:
        named = bool(column.names) and column.names[0].endswith(f"[{place}]") and len(column.values) == rows
        clock = named and runs_forward(column.values)
        if clock and 0.0 < (step := float(np.median(np.diff(column.values)))) < 1.0:
            return float(f"{1.0 / step:.6g}")
    return None
