"""A trial as it was recorded: its channels in SI units, each with its own times."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spacerobot.recordings import units
from spacerobot.recordings.body_frame import turn_to_world
from spacerobot.recordings.channel import ChannelSpec, dimensions
from spacerobot.recordings.cleaning import ENOUGH, clock_times, doubted_values, joined_rows, keep_rows, used_values
from spacerobot.recordings.dataroot import inside
from spacerobot.recordings.held import fresh, held_for
from spacerobot.recordings.readers import read_table
from spacerobot.recordings.series import Series, estimate_noise
from spacerobot.recordings.stream import StreamSpec
from spacerobot.recordings.table import Floats, Options, RawTable
from spacerobot.recordings.trial import Source, Trial
from spacerobot.support.errors import InputError, NotFoundError
from spacerobot.support.showing import html_table
from spacerobot.support.tables import data_set, joined

if TYPE_CHECKING:
    import pandas
    import xarray

EPOCH = 1e8
"""Times beyond this many seconds count from an epoch (1973 and later), not from the start of a recording."""


SPARSE = 0.5
"""Share of rows with a reading below which a channel is a slower sensor's than its log's others: those rows are all."""


@dataclass(frozen=True)
class Recording(Mapping[str, Series]):
    """The channels of one trial, by canonical name.

    Attributes:
        trial: what was recorded.
        series: channel -> samples.
        notes: what was done to the data, or is odd about them: repeated rows, gaps, epoch times.
        epoch: clock -> seconds taken off its times (0 unless they count from an epoch).
    """

    trial: Trial
    series: Mapping[str, Series]
    notes: tuple[str, ...] = ()
    epoch: Mapping[str, float] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"Recording(trial {self.trial.id}: {', '.join(self.series)})"

    def _repr_html_(self) -> str:
        rows = []
        for s in self.series.values():
            good = s.good()[1]
            ends = (float(good.min()), float(good.max())) if good.size else (None, None)
            rows.append((s.name, *ends, s.unit, len(s), s.sigma if np.isfinite(s.sigma) else None, s.stream))
        head = ("channel", "lowest", "highest", "unit", "samples", "noise, one σ", "stream")
        return html_table(f"Trial {self.trial.id}", rows, head, self.notes)

    def to_frame(self) -> pandas.DataFrame:
        """Every channel over all times of any, SI; NaN where a channel has no sample, as a table of pandas.

        Raises:
            InputError: pandas is not installed.
        """
        return joined([series.to_frame() for series in self.series.values()])

    def to_xarray(self) -> xarray.Dataset:
        """Every channel over its own stream's times, `time_STREAM`, with units, as a data set of xarray.

        Raises:
            InputError: xarray is not installed.
        """
        times = {s.stream: f"time_{s.stream}" for s in self.series.values()}
        coordinates = {times[s.stream]: (times[s.stream], s.time, "s") for s in self.series.values()}
        variables = {name: (times[s.stream], s.value, s.unit) for name, s in self.series.items()}
        return data_set(variables, coordinates, trial=self.trial.id)

    def __getitem__(self, name: str) -> Series:
        if name not in self.series:
            raise NotFoundError(f"channel of trial {self.trial.id}", name, self.series)
        return self.series[name]

    def __contains__(self, name: object) -> bool:
        return name in self.series

    def __iter__(self) -> Iterator[str]:
        return iter(self.series)

    def __len__(self) -> int:
        return len(self.series)

    def inputs(self) -> tuple[Series, ...]:
        """Commanded or known channels."""
        return tuple(s for s in self.series.values() if s.use == "input")

    def outputs(self) -> tuple[Series, ...]:
        """Measured channels."""
        return tuple(s for s in self.series.values() if s.use == "output")


def load_trial(streams: Mapping[str, StreamSpec], root: Path, trial: Trial) -> Recording:
    """Read all streams of one trial.

    Args:
        streams: name -> how its files are read.
        root: folder that the trial's files are relative to; none outside it is opened.
        trial: the trial.

    Raises:
        InputError: a file cannot be read or makes no sense; with file, line and reason.
    """
    raw: dict[str, tuple[RawTable, Floats, Floats]] = {}
    notes: list[str] = []
    for name, source in trial.sources.items():
        stream = streams[name]
        table = _read(root, trial, stream, source)
        time = _times(root, trial, stream, source, table)
        values = joined_rows(time, used_values(table, stream, len(time)))
        raw[name] = (table, time, values)
    epoch = _epochs(streams, raw)
    series: dict[str, Series] = {}
    for name, (table, time, values) in raw.items():
        stream = streams[name]
        shift = epoch[stream.clock]
        keep, remarks = keep_rows(table, stream, time, values)
        notes += [f"{name}: {remark}" for remark in (*table.notes, *remarks)]
        if shift:
            notes.append(f"{name}: times count from an epoch; {shift:.0f} s taken off")
        time, values = time[keep] - shift, values[keep]
        beside = {name: column[keep] for name, column in doubted_values(table, stream).items()}
        if trial.window is not None and stream.kind == "samples":
            within = (time >= trial.window[0]) & (time <= trial.window[1])
            if not within.any():
                raise InputError(
                    "the trial's window holds no sample",
                    given=list(trial.window),
                    valid=f"{time[0]:g} to {time[-1]:g} s",
                    where=trial.where,
                )
            time, values = time[within], values[within]
            beside = {name: column[within] for name, column in beside.items()}
        held: dict[int, list[str]] = {}
        for j, channel in enumerate(stream.channels):
            if channel.name in series:
                raise InputError(
                    f"two streams both give {channel.name}",
                    given=f"{series[channel.name].stream}, {name}",
                    where=channel.where,
                )
            valid = np.isfinite(values[:, j])
            if not valid.any():
                raise InputError(
                    f"{channel.name} has no reading at all",
                    given=f"column {channel.column}",
                    where=str(table.path),
                )
            factor = channel.factor
            if channel.unit is None:  # then the file's own word counts, where it gives one
                own = table.columns[table.index(channel.column)].unit
                factor = units.factor(own, dimensions(channel.quantity), where=str(table.path)) if own else 1.0
            value = (values[:, j] * channel.scale + channel.offset + trial.offsets.get(channel.name, 0.0)) * factor
            if channel.unwrap:
                value[valid] = np.unwrap(value[valid])
            rows = held_for(value) if _sensed(channel, stream) else 1
            new = fresh(value, rows) if rows > 1 else slice(None)
            if valid.mean() < SPARSE and valid.sum() >= ENOUGH:
                rows, new = 1, valid
            if rows > 1:
                held.setdefault(rows, []).append(channel.name)
            stated = channel.sigma is not None
            sigma = channel.sigma if channel.sigma is not None else np.nan
            if not stated and stream.kind == "samples":
                sigma = estimate_noise(value[new])
            series[channel.name] = Series(
                channel.name,
                time[new],
                value[new],
                valid[new],
                sigma,
                stated,
                name,
                stream.clock,
                channel.si_unit,
                channel.use,
                channel.offset_sigma * factor,
                {column: (factor * beside[column][new], sigma) for column, sigma in channel.plus_sigma},
            )
        for rows, names in held.items():
            notes.append(f"{name}: each reading stands in {rows} rows, of which the first counts: {', '.join(names)}")
    specs = [c for name in trial.sources for c in streams[name].channels]
    turn_to_world(specs, series)
    return Recording(trial, series, tuple(notes), epoch)


def _sensed(channel: ChannelSpec, stream: StreamSpec) -> bool:
    """Whether a channel is a sensor's; a command holds until the next one, and is what it says meanwhile."""
    return stream.kind == "samples" and channel.use == "output" and not channel.name.endswith(".reference")


def _read(root: Path, trial: Trial, stream: StreamSpec, source: Source) -> RawTable:
    wanted = {c.column for c in stream.channels} | {name for c in stream.channels for name, _ in c.plus}
    if stream.time is not None and source.time_file is None:
        wanted.add(stream.time)
    options = Options(
        variable=source.variable or stream.variable,
        separator=stream.separator,
        decimal=stream.decimal,
        header_rows=stream.header_rows,
        rows=source.rows or stream.rows,
        reshape=stream.reshape,
        compression=stream.compression,
        encoding=stream.encoding,
        wanted=frozenset(wanted),
    )
    return read_table(inside(root, source.file, where=trial.where, folder=None), options, stream.format)


def _times(root: Path, trial: Trial, stream: StreamSpec, source: Source, table: RawTable) -> Floats:
    """The time of each row, s, in the file's own count."""
    rows = len(table.columns[table.index(stream.channels[0].column, where=stream.channels[0].where)].values)
    if stream.time is None:
        return stream.time_offset + np.arange(rows) / (stream.rate or 1.0)
    said = None
    if source.time_file is None:
        column = table.columns[table.index(stream.time, where=stream.channels[0].where)]
        time, said = column.values, column.unit
    else:
        path = inside(root, source.time_file, where=trial.where)
        options = Options(compression=stream.compression, rows=source.rows or stream.rows)
        time = read_table(path, options)[stream.time]
    if len(time) != rows:
        raise InputError(
            "times and readings differ in number",
            given=f"{len(time)} times, {rows} readings",
            where=str(table.path),
        )
    factor = units.factor(stream.time_unit or said or "s", ("time",), where=str(table.path))
    return clock_times(table, time * factor + stream.time_offset)


def _epochs(streams: Mapping[str, StreamSpec], raw: Mapping[str, tuple[RawTable, Floats, Floats]]) -> dict[str, float]:
    """Clock -> whole seconds to take off: the earliest start of its streams, if they count from an epoch."""
    starts: dict[str, float] = {}
    for name, (_, time, _) in raw.items():
        clock = streams[name].clock
        starts[clock] = min(starts.get(clock, np.inf), float(time.min()) if len(time) else np.inf)
    return {clock: float(np.floor(s)) if EPOCH < s < np.inf else 0.0 for clock, s in starts.items()}
