"""Trials one beneath the other in one table: each stretch of rows as a file of its own.

A column numbers the trials, or the clock begins anew with each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import PurePath

import numpy as np

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.languages import words_in
from spacerobot.recordings.drafting.masses import scalars, with_masses
from spacerobot.recordings.drafting.names import named, without_ending
from spacerobot.recordings.drafting.vocabulary import TRIALS
from spacerobot.recordings.guess import is_called_time, runs_forward
from spacerobot.recordings.table import Floats, RawTable

SHORTEST = 10
"""Rows of a trial: fewer are a counter that wraps, or a clock that stumbles."""


def trials_beneath(file: Found) -> list[Found]:
    """The file's trials as files of their own, where it holds several one beneath the other; else the file."""
    columns = [file.table.columns[j] for j in file.usable]
    columns = [c for c in columns if len(c.values) == file.rows]
    numbered = (c.values for c in columns if c.names and (said := set(words_in(c.names[0]))) and said <= TRIALS)
    timed = (c.values for c in columns if any(map(is_called_time, c.names)))
    for starts, names in [*map(_numbered, numbered), *map(_begun_anew, timed)]:
        if len(starts) > 1:
            return [_part(file, a, b, name) for a, b, name in zip(starts, [*starts[1:], file.rows], names)]
    return [file]


def _numbered(values: Floats) -> tuple[list[int], list[str]]:
    """First rows and names of stretches with one number each, none where a number comes again or is no whole one."""
    if not np.isfinite(values).all() or (values != np.round(values)).any():
        return [], []
    starts = [0, *(np.flatnonzero(np.diff(values)) + 1).tolist()]
    numbers = [f"{values[i]:.0f}" for i in starts]
    return (starts, numbers) if len(set(numbers)) == len(starts) and _long(starts, len(values)) else ([], [])


def _begun_anew(values: Floats) -> tuple[list[int], list[str]]:
    """First rows and names of stretches in which a clock runs forward; none where it runs so throughout.

    Each falls back to the beginning rather than to what was just before: a clock that stumbles begins nothing.
    """
    if not np.isfinite(values).all():
        return [], []
    starts = [0, *(np.flatnonzero(np.diff(values) < 0) + 1).tolist()]
    forward = _long(starts, len(values)) and all(map(runs_forward, np.split(values, starts[1:])))
    forward = forward and all(abs(values[i] - values[0]) < values[i - 1] - values[i] for i in starts[1:])
    return (starts, [str(n) for n in range(1, len(starts) + 1)]) if forward else ([], [])


def _long(starts: Sequence[int], rows: int) -> bool:
    return min(np.diff([*starts, rows])) >= SHORTEST


def _part(file: Found, first: int, last: int, name: str) -> Found:
    """Some of the file's rows; what they say of the target's mass is this trial's."""
    columns = tuple(replace(c, values=c.values[first:last]) for c in file.table.columns)
    lines = file.table.lines
    table = RawTable(file.table.path, columns, None if lines is None else lines[first:last], file.table.notes)
    path = PurePath(file.relative)
    said = named(path.with_name(f"{without_ending(path.name)}_{name}"))
    return replace(file, table=table, named=with_masses(said, scalars(table)), span=(first, last))
