"""A study's recordings as the fits read them: per trial, blocks of channels that share times."""

from __future__ import annotations

import functools
import re
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.terms.alignment import clocks_of, within
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.series import Series
from spacerobot.recordings.study import Study


@dataclass(frozen=True, eq=False)
class Block:
    """Channels of one stream in one trial that share their times. C channels, T times."""

    stream: str
    channels: tuple[str, ...]
    time: np.ndarray  # (T,) s
    value: np.ndarray  # (C, T) SI, zero where not valid
    weight: np.ndarray  # (C, T) 1/sigma, zero where not valid
    clock: str = ""  # whose own the times are, set beside the trial's by the touch; the trial's where empty
    late: float = 0.0  # what that took off the times [s]


def piece_id(trial: str, number: int) -> str:
    """What the piece of a recorded trial is called."""
    return f"{trial}@{number}"


def recorded_id(name: str) -> str:
    """The recorded trial of a piece, or of a whole trial; another @ stays."""
    return re.sub(r"(@\d+)+$", "", name)


@dataclass(frozen=True, eq=False)
class TrialData:
    """One trial as a fit reads it.

    Attributes:
        id, condition, overrides: as in the study; of a piece, the trial's with its number.
        blocks: what was read.
        start, end: in s.
        repeats: the piece of the same trial at whose place the machine still stands: it tells the same once more.
    """

    id: str
    condition: str
    overrides: Mapping[str, float]
    blocks: tuple[Block, ...]
    start: float
    end: float
    repeats: str = ""

    @property
    def recorded(self) -> str:
        """The recorded trial that this one is, or is a piece of."""
        return recorded_id(self.id)

    @property
    def told_by(self) -> str:
        """The trial that says what this one says: itself, or the piece that it repeats."""
        return self.repeats or self.id

    @functools.cached_property
    def channels(self) -> tuple[str, ...]:
        """All channels, in block order."""
        return tuple(c for b in self.blocks for c in b.channels)

    @functools.cached_property
    def valid(self) -> np.ndarray:
        """Which samples are, of all blocks and channels in a row, shape (S,) bool."""
        return np.concatenate([(b.weight > 0.0).ravel() for b in self.blocks])

    @functools.cached_property
    def cuts(self) -> tuple[int, ...]:
        """Where one channel's samples end in such a row and the next one's begin."""
        return tuple(ends_of([self])[1:-1].tolist())

    @property
    def samples(self) -> int:
        """Number of valid samples."""
        return int(self.valid.sum())

    def channel(self, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Times, values and weights of one channel, valid samples only."""
        for block in self.blocks:
            if name in block.channels:
                i = block.channels.index(name)
                good = block.weight[i] > 0.0
                return block.time[good], block.value[i][good], block.weight[i][good]
        raise KeyError(name)


def ends_of(trials: Sequence[TrialData]) -> np.ndarray:
    """Where the channels' samples begin and end where those of all trials stand in a row, from 0 on."""
    return np.cumsum([0, *(b.time.size for t in trials for b in t.blocks for _ in b.channels)])


def trial_data(study: Study, shown: Container[str] | None = None) -> tuple[TrialData, ...]:
    """Every trial's output channels, grouped by stream and times; those that a model shows, if it says which.

    An instrument has one noise: where the study does not state it, what the trials show of it counts together.
    """
    recordings = [study.recording(trial) for trial in study.trials]
    trials = [one_trial(study, recording, shown) for recording in recordings]
    found: dict[str, list[float]] = {}
    for recording in recordings:
        for name, series in recording.items():
            if not series.sigma_stated and np.isfinite(series.sigma):
                found.setdefault(name, []).append(series.sigma)
    noise = {name: float(np.median(some)) for name, some in found.items()}
    return tuple(replace(t, blocks=tuple(_with_noise(b, noise) for b in t.blocks)) for t in trials)


def _with_noise(block: Block, noise: Mapping[str, float]) -> Block:
    """A block whose channels have this noise, where it is told."""
    weight = block.weight.copy()
    for c, channel in enumerate(block.channels):
        if noise.get(channel, 0.0) > 0.0:
            weight[c] = (weight[c] > 0.0) / noise[channel]
    return replace(block, weight=weight)


def one_trial(study: Study, recording: Recording, shown: Container[str] | None = None) -> TrialData:
    """As `trial_data`, of one recording that has some such channel.

    Raises:
        InputError: where a stream's own clock stands beside the others' cannot be found.
    """
    groups: dict[tuple[str, bytes], list[Series]] = {}
    used = {n: s for n, s in recording.items() if s.use == "output" and (shown is None or n in shown)}
    clocks = clocks_of(recording, tuple(used))
    told = [s.time for s in used.values() if s.clock == clocks.reference]
    begin, end = min(t[0] for t in told), max(t[-1] for t in told)
    for series in used.values():
        if series.clock in clocks.late:
            series = within(series, clocks.on_reference(series), (begin, end))
        groups.setdefault((series.stream, series.time.tobytes()), []).append(series)
    blocks = []
    for (stream, _), rows in groups.items():
        value = np.array([np.where(s.valid, s.value, 0.0) for s in rows])
        weight = np.array([s.valid / s.sigma for s in rows])
        clock = rows[0].clock if rows[0].clock in clocks.late else ""
        late = clocks.late.get(clock, 0.0)
        blocks.append(Block(stream, tuple(s.name for s in rows), rows[0].time, value, weight, clock, late))
    trial = recording.trial
    return TrialData(trial.id, study.condition(trial), trial.overrides, tuple(blocks), begin, end)
