"""Numbers that no sensor gives: the sign of memory that was logged before anything was written to it."""

from __future__ import annotations

import numpy as np

from spacerobot.recordings.table import Options, RawTable
from spacerobot.support.errors import InputError

TINY, HUGE = 1e-290, 1e90
"""Magnitudes beyond any sensor. Pointers and small integers read as doubles fall below, text above."""


def refuse_garbage(table: RawTable, options: Options) -> None:
    """Refuse a table in which a wanted column (any, where none is named) holds such a number.

    Raises:
        InputError: with the first such row.
    """
    worst: tuple[int, int] | None = None
    for j, column in enumerate(table.columns):
        if options.wanted is not None and not options.wanted & {*column.names, str(j)}:
            continue
        magnitude = np.abs(column.values)
        bad = ((magnitude > 0) & (magnitude < TINY)) | (magnitude > HUGE)
        if bad.any():
            row = int(np.argmax(bad))
            worst = min(worst, (row, j)) if worst else (row, j)
    if worst is not None:
        row, j = worst
        raise InputError(
            f"column {table.names()[j]!r} holds a number no sensor gives: memory that was never written to",
            given=f"{table.columns[j].values[row]:g}",
            where=table.at(row),
        )
