"""A column of a file over the file's own clock."""

from __future__ import annotations

import numpy as np

from spacerobot.recordings.drafting.approach import Track
from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.guess import UNTIMED, time_unit, unsaid_unit
from spacerobot.recordings.held import fresh, held_for
from spacerobot.recordings.table import Floats
from spacerobot.recordings.units import UNITS


def clock(file: Found) -> Floats | None:
    """The file's times, s, from 0 at the rate that is stated where it has no clock; None where nothing says them."""
    if file.times is not None:
        return file.times[2]
    index = file.clock
    if index is None:
        return np.arange(file.rows) / file.rate if file.rate is not None else None
    column = file.table.columns[index]
    return column.values * UNITS[unsaid_unit(column) or time_unit(column)].factor


def timed(file: Found) -> bool:
    """Whether the file's times are known: by its clock, or by a rate that is stated."""
    return file.times is not None or file.clock is not None or file.rate is not None


def span(file: Found) -> tuple[float, float] | None:
    """When the file begins and ends by its own clock, s."""
    time = clock(file)
    if time is None or not np.isfinite(time).any():
        return None
    return float(np.nanmin(time)), float(np.nanmax(time))


def values(file: Found, column: str) -> Floats:
    """The readings of a column, in the file's unit."""
    return file.table.columns[file.table.index(column)].values


def track(file: Found, column: str, readings: Floats | None = None) -> Track | None:
    """A column over the file's own clock, s, without what is missing; evenly spaced where the file has none.

    Args:
        file: the file.
        column: its column.
        readings: instead of the column's own.
    """
    time = clock(file)
    value = values(file, column) if readings is None else readings
    if time is None:
        time = np.arange(len(value)) / UNTIMED
    if len(value) != len(time):
        return None
    good = np.isfinite(time) & np.isfinite(value)
    if (rows := held_for(value)) > 1:
        good &= fresh(value, rows)
    return Track(time[good], value[good]) if good.sum() > 2 else None
