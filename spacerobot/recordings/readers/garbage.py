"""Numbers that no sensor gives: the sign of memory that was logged before anything was written to it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spacerobot.recordings.table import Column, Options, RawTable
from spacerobot.support.errors import InputError

TINY, HUGE = 1e-290, 1e90
"""Magnitudes beyond any sensor. Pointers and small integers read as doubles fall below, text above."""


def _bad(column: Column) -> NDArray[np.bool_]:
    magnitude = np.abs(column.values)
    found: NDArray[np.bool_] = ((magnitude > 0) & (magnitude < TINY)) | (magnitude > HUGE)
    return found


def written_to(column: Column) -> bool:
    """Whether a sensor may have given all of the column's numbers."""
    return not bool(_bad(column).any())


def refuse_garbage(table: RawTable, options: Options) -> None:
    """Refuse a table in which a wanted column (any, where none is named) holds such a number.

    Raises:
        InputError: with the first such row.
    """
    worst: tuple[int, int] | None = None
    for j, column in enumerate(table.columns):
        if options.wanted is not None and not options.wanted & {*column.names, str(j)}:
            continue
        bad = _bad(column)
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
