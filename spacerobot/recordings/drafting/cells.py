"""Files that hold several trials: a cell array of matrices, an array of structs or a group for each, one a trial."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import PurePath

import numpy as np

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.languages import words_in
from spacerobot.recordings.drafting.masses import scalars, with_masses
from spacerobot.recordings.drafting.names import is_measured, named, without_ending
from spacerobot.recordings.drafting.vocabulary import THINGS
from spacerobot.recordings.guess import is_time, runs_forward
from spacerobot.recordings.table import Column, RawTable

_IN_CELL = re.compile(r"(?P<cell>[^\[\]]+)\[(?P<place>\d+)\]\[(?:\d+|\d+,:)\]")
"""A column or a row of a matrix in a cell, as `readers.arrays` calls them."""

_IN_MATRIX = re.compile(r"(?P<matrix>[^\W\d_]{2,}[^\W\d]*\d+)\[\d+\]")
"""A column of a matrix that is one of several by its number: run_3[0]; a letter and a number are a symbol."""


def trials_in(file: Found) -> list[Found]:
    """The file's trials as files of their own, where it holds several that are alike; else the file."""
    if file.variable is not None:
        return [file]
    return _structs(file) or _cells(file) or _matrices(file) or [file]


def _structs(file: Found) -> list[Found]:
    """Structs and groups of the same fields as files, where each has a clock and their names tell a number alone."""
    members: dict[str, list[int]] = {}
    for j, column in enumerate(file.table.columns):
        owner, dot, _ = (column.names[0] if column.names else "").partition(".")
        if dot:
            members.setdefault(owner, []).append(j)
    tables = {owner: _inside(file.table, owner, own) for owner, own in members.items()}
    alike = len({tuple(c.names[0] for c in table.columns) for table in tables.values()}) == 1
    timed = all(any(map(is_time, table.columns)) for table in tables.values())
    if len(members) < 2 or not (alike and timed and all(map(_is_a_number, members))):
        return []
    stem = without_ending(PurePath(file.relative).name)
    return [
        replace(
            file,
            table=tables[owner],
            usable=tuple(n for n, j in enumerate(own) if j in file.usable),
            named=with_masses(named(PurePath(file.relative).with_name(f"{stem}_{owner}")), scalars(tables[owner])),
            variable=owner,
        )
        for owner, own in members.items()
    ]


def _inside(table: RawTable, owner: str, places: Sequence[int]) -> RawTable:
    """A struct's columns, called by its fields."""
    own = [table.columns[j] for j in places]
    columns = [replace(c, names=tuple(n.removeprefix(f"{owner}.") for n in c.names)) for c in own]
    return RawTable(table.path, tuple(columns), None, table.notes)


def _is_a_number(owner: str) -> bool:
    """Whether a name tells a number, of something that is not measured: run3, not joint3, pose3 or target3."""
    things = {called for words in THINGS.values() for called in words}
    said = {w for word in words_in(owner) for w in (word, word.rstrip("0123456789"))}
    return bool(named(PurePath(owner)).keys) and not (said & things or any(map(is_measured, said)))


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


def _matrices(file: Found) -> list[Found]:
    """Matrices of one width as files, where their names tell a number and not what is measured."""
    owners: dict[str, list[Column]] = {}
    usable = [file.table.columns[j] for j in file.usable]
    for column in usable:
        inside = _IN_MATRIX.fullmatch(column.names[0]) if column.names else None
        if inside is not None:
            owners.setdefault(inside["matrix"], []).append(column)
    widths = {len(own) for own in owners.values()}
    if len(owners) < 2 or len(widths) > 1 or sum(map(len, owners.values())) < len(usable):
        return []
    if not all(map(_is_a_number, owners)):
        return []
    stem = without_ending(PurePath(file.relative).name)
    return [
        replace(
            file,
            table=RawTable(file.table.path, tuple(Column((), c.values, c.unit) for c in own), None, file.table.notes),
            usable=tuple(range(len(own))),
            named=named(PurePath(file.relative).with_name(f"{stem}_{owner}")),
            variable=owner,
        )
        for owner, own in owners.items()
    ]
