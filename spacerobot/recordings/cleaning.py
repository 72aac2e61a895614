"""From raw columns to rows that can be trusted: refusing what cannot be, marking what is missing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spacerobot.recordings.channel import ChannelSpec
from spacerobot.recordings.stream import StreamSpec
from spacerobot.recordings.table import Floats, RawTable
from spacerobot.support.errors import InputError

_FLOOD = 0.98

ENOUGH = 50
"""Readings that a channel has whatever the rows without one: those of a slow sensor in the log of a fast one."""


def clock_times(table: RawTable, time: Floats) -> Floats:
    """`time` with every entry finite.

    Raises:
        InputError: with the first line whose time is missing.
    """
    if len(time) == 0:
        raise InputError("the file has no rows", where=str(table.path))
    bad = np.flatnonzero(~np.isfinite(time))
    if len(bad):
        raise InputError("the row has no time", where=table.at(int(bad[0])))
    return time


def used_values(table: RawTable, stream: StreamSpec, rows: int) -> Floats:
    """The raw readings of the stream's channels, NaN where missing: (rows, channels).

    A channel that adds other columns is given as the one reading that would do for them all.

    Raises:
        InputError: columns of different length, or hardly a reading at all.
    """
    values = np.empty((rows, len(stream.channels)))
    for j, channel in enumerate(stream.channels):
        values[:, j] = _readings(table, channel.column, channel, rows)
        for column, factor in channel.plus:
            values[:, j] += factor / channel.scale * _readings(table, column, channel, rows)
        lost = np.isnan(values[:, j])
        if rows > 20 and lost.mean() > _FLOOD and rows - lost.sum() < ENOUGH:
            raise InputError(
                f"{channel.name} is missing nearly everywhere",
                given=f"{int(lost.sum())} of {rows} rows without a reading",
                where=table.at(0),
            )
    return values


def doubted_values(table: RawTable, stream: StreamSpec) -> dict[str, Floats]:
    """The raw readings of columns whose factor in a channel is doubted, NaN where missing: (rows,) each."""
    return {
        column: _readings(table, column, channel, len(table.columns[table.index(channel.column)].values))
        for channel in stream.channels
        for column, _ in channel.plus_sigma
    }


def _readings(table: RawTable, name: str, channel: ChannelSpec, rows: int) -> Floats:
    """One column, NaN where it is missing."""
    column = table.columns[table.index(name, where=channel.where)].values
    if len(column) != rows:
        raise InputError(
            f"column {name!r} has another length than the times",
            given=f"{len(column)} values, {rows} times",
            where=str(table.path),
        )
    seen = np.isfinite(column)
    if channel.missing:
        seen &= ~np.isin(column, channel.missing)
    return np.where(seen, column, np.nan)


def joined_rows(time: Floats, values: Floats) -> Floats:
    """The readings with what rows of one time hold of different channels in each of them, (rows, channels).

    A log of several sensors may have a row for each. Where a channel has two readings at one time, all stay so.
    """
    new = np.concatenate(([True], np.diff(time) != 0))
    if new.all():
        return values
    starts, group = np.flatnonzero(new), np.cumsum(new) - 1
    least, most = np.fmin.reduceat(values, starts), np.fmax.reduceat(values, starts)
    agree = np.all((least == most) | np.isnan(least), axis=1)
    return np.where(agree[group][:, None], least[group], values)


def keep_rows(
    table: RawTable, stream: StreamSpec, time: Floats, values: Floats
) -> tuple[NDArray[np.int64], tuple[str, ...]]:
    """Indices of the rows to keep, in order of time, and remarks on the others.

    A row with the time and readings of the row before is a repeat and left out. One with the readings alone
    is left out only if the stream says `repeated = "drop"`: a body at rest repeats itself honestly. One with the time
    alone is refused, or left out by itself where the stream says `repeated = "first"`.

    Raises:
        InputError: time runs backwards (without `sort`), or stands still while the readings change.
    """
    order = np.arange(len(time), dtype=np.int64)
    step = np.diff(time)
    remarks: list[str] = []
    if (step < 0).any():
        row = int(np.argmax(step < 0)) + 1
        if not stream.sort:
            raise InputError(
                "time runs backwards",
                given=f"{time[row]:.9g} after {time[row - 1]:.9g}",
                valid="an increasing clock, or sort = true for the stream",
                where=table.at(row),
            )
        order = np.argsort(time, kind="stable").astype(np.int64)
        time, values = time[order], values[order]
        step = np.diff(time)
        remarks.append("rows sorted by time")
    same = np.all((values[1:] == values[:-1]) | (np.isnan(values[1:]) & np.isnan(values[:-1])), axis=1)
    still = step == 0
    conflict = still & ~same
    if conflict.any() and stream.repeated == "keep":
        row = int(np.argmax(conflict)) + 1
        raise InputError(
            "time stands still while the readings change",
            given=f"{int(conflict.sum())} times",
            valid='repeated = "first" keeps the first row of each time, and all others',
            where=table.at(int(order[row])),
        )
    drop = still | same if stream.repeated == "drop" else still
    if drop.any():
        remarks.append(f"{int(drop.sum())} of {len(time)} rows repeat the row before and are left out")
    elif same.mean() > 0.02 if len(same) else False:
        remarks.append(f"{int(same.sum())} of {len(time)} rows repeat the readings before (kept)")
    keep = np.concatenate(([True], ~drop))
    kept = np.diff(time[keep])
    if len(kept) > 2:
        gaps = kept > 3.5 * np.median(kept)
        if gaps.any():
            remarks.append(f"{int(gaps.sum())} gaps, the longest {kept.max():.4g} s")
    return order[keep], tuple(remarks)
