"""Readings that a log holds: a camera at 5 Hz in a table at 10 Hz says each of its readings twice.

The second one is no reading. It shows the body where it was, and a fit takes it for noise or for a delay.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spacerobot.recordings.table import Floats

FEWEST = 12
"""Runs of one value between changes below which their lengths say nothing."""

REGULAR = 0.95
"""Share of the runs that have the length of a held reading: a body at rest holds a value longer, a lost frame too."""

ALIKE = 0.9
"""Share of steps of the smallest size from which a signal counts: its runs are honest."""

MOST_ALIKE = 3
"""Readings one after the other that are the same by rounding: holds of 8 or 9 rows, but of 24 or more anything."""


def held_for(value: Floats) -> int:
    """For how many rows a log holds each reading of a channel; 1 where it holds none.

    A signal that counts whole steps repeats itself where it is slow, for longer and shorter: so regularly only what is
    held does. Rates that are no multiple of each other hold for one row more now and then: then that many.

    Args:
        value: shape (T,), NaN where there is no reading.
    """
    seen = value[np.isfinite(value)]
    changes = np.flatnonzero(np.diff(seen))
    runs = np.diff(changes)
    if runs.size < FEWEST:
        return 1
    rows = int(np.bincount(runs).argmax())
    if rows < 2:
        return 1
    steps = np.abs(np.diff(seen)[changes])
    counts = steps / steps.min()
    one = (counts < 1.5) & (np.abs(counts - np.round(counts)) < 1e-3)
    if np.mean(one) >= ALIKE:
        return 1
    if np.mean(runs % rows == 0) >= REGULAR:
        return rows
    holds = np.arange(1, MOST_ALIKE + 1)[:, None]
    near = ((runs >= holds * rows) & (runs <= holds * (rows + 1))).any(axis=0)
    return rows + 1 if np.mean(near) >= REGULAR else 1


def fresh(value: Floats, rows: int) -> NDArray[np.bool_]:
    """Which rows say something new, shape (T,): the first of each run of one value, and of each hold in a longer one.

    A first run that is shorter than a hold began before the first row.

    Args:
        value: shape (T,), NaN where there is no reading; those rows stay.
        rows: for how many a reading is held.
    """
    new = np.concatenate(([True], value[1:] != value[:-1]))
    row = np.arange(value.size)
    out = (row - np.maximum.accumulate(np.where(new, row, 0))) % rows == 0
    out[0] = not new[1:rows].any()
    return np.asarray(out)
