"""Files that hold several trials: a cell array of matrices, an array of structs or a group for each, one a trial."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import PurePath

import numpy as np

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.masses import scalars, with_masses
from spacerobot.recordings.drafting.names import is_measured, named, without_ending
from spacerobot.recordings.guess import runs_forward
from spacerobot.recordings.table import Column, RawTable

_IN_CELL = re.compile(r"(?P<cell>[^\[\]]+)\[(?P<place>\d+)\]\[(?:\d+|\d+,:)\]")
"""A column or a row of a matrix in a cell, as `readers.arrays` calls them."""


def trials_in(file: Found) -> list[Found]:
    """The file's trials as files of their own, where it holds several that are alike; else the file."""
    return _structs(file) or _cells(file) or [file]


def _structs(file: Found) -> list[Found]:
    """Structs and groups of the same fields as files, where their names tell a number and not what is measured."""
    members: dict[str, list[int]] = {}
    for j, column in enumerate(file.table.columns):
        owner, dot, _ = (column.names[0] if column.names else "").partition(".")
        if dot:
            members.setdefault(owner, []).append(j)
    called = {owner: named(PurePath(owner)) for owner in members}
    fields = {tuple(_field(file.table.columns[j]) for j in own) for own in members.values()}
    numbered = all(c.keys and not any(map(is_measured, c.words)) for c in called.values())
    if len(members) < 2 or len(fields) > 1 or not numbered:
        return []
    stem = without_ending(PurePath(file.relative).name)
    found = []
    for owner, own in members.items():
        columns = tuple(
            replace(c, names=tuple(n.removeprefix(f"{owner}.") for n in c.names))
            for c in (file.table.columns[j] for j in own)
        )
        table = RawTable(file.table.path, columns, None, file.table.notes)
        path = PurePath(file.relative).with_name(f"{stem}_{owner}")
        found.append(
            replace(
                file,
                table=table,
                usable=tuple(n for n, j in enumerate(own) if j in file.usable),
                named=with_masses(named(path), scalars(table)),
                variable=owner,
            )
        )
    return found


def _field(column: Column) -> str:
    return column.names[0].partition(".")[2]


def _cells(file: Found) -> list[Found]:
    """The file's matrices as files.

    Their columns go by place, since their names differ from trial to trial; a clock in a cell beside gives their rate.
    """
    cells: dict[tuple[str, int], list[Column]] = {}
    for column in file.table.columns:
        inside = _IN_CELL.fullmatch(column.names[0]) if column.names else None
        if inside is not None:
            cells.setdefault((inside["cell"], int(inside["place"])), []).append(column)
    if len(cells) < 2 or len({len(own) for own in cells.values()}) > 1:
        return []
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
