"""Times that a lab keeps in a file of their own, beside files without a clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import PurePath

import numpy as np

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.vocabulary import words
from spacerobot.recordings.guess import SLOWEST, runs_forward

_TIMES = words("t time times timestamp timestamps stamp stamps clock")


def with_times(files: Sequence[Found]) -> list[Found]:
    """The files, those of times alone put to those of the same folder, numbers and rows that name no clock."""
    clocks = {f.relative: f for f in files if _is_clock(f)}
    out: list[Found] = []
    used: set[str] = set()
    for file in files:
        if file.relative in clocks:
            continue
        mine = [c for c in clocks.values() if _beside(c, file)]
        if len(mine) == 1 and (file.clock is None or not file.table.columns[file.clock].names):
            used.add(mine[0].relative)
            table = mine[0].table
            file = replace(file, times=(mine[0].relative, table.names()[0], table.columns[0].values))
        out.append(file)
    return [*out, *(c for name, c in clocks.items() if name not in used)]


def _is_clock(file: Found) -> bool:
    """Whether the file is called times and holds nothing else, in seconds by its steps."""
    if len(file.table.columns) != 1 or not _TIMES.intersection(file.named.words) or file.variable is not None:
        return False
    values = file.table.columns[0].values
    return runs_forward(values) and float(np.median(np.diff(values))) < SLOWEST


def _beside(clock: Found, file: Found) -> bool:
    together = PurePath(clock.relative).parent == PurePath(file.relative).parent
    return together and clock.named.keys == file.named.keys and clock.rows == file.rows
