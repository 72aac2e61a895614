"""A study's recordings as the fits read them: per trial, blocks of channels that share times."""

from __future__ import annotations

import functools
import re
from collections.abc import Container, Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.recordings.recording import Recording
from spacerobot.recordings.study import Study


@dataclass(frozen=True, eq=False)
class Block:
    """Channels of one stream in one trial that share their times. C channels, T times."""

    stream: str
    channels: tuple[str, ...]
    time: np.ndarray  # (T,) s
    value: np.ndarray  # (C, T) SI, zero where not valid
    weight: np.ndarray  # (C, T) 1/sigma, zero where not valid


def piece_id(trial: str, number: int) -> str:
    """What the piece of a recorded trial is called."""
    return f"{trial}@{number}"


def recorded_id(name: str) -> str:
    """The recorded trial of a piece, or of a whole trial; another @ stays."""
    return re.sub(r"(@\d+)+$", "", name)


@dataclass(frozen=True, eq=False)
class TrialData:
    """One trial as a fit reads it."""

    id: str
    condition: str
    overrides: Mapping[str, float]
    blocks: tuple[Block, ...]
    start: float
    end: float

    @property
    def recorded(self) -> str:
        """The recorded trial that this one is, or is a piece of."""
        return recorded_id(self.id)

    @functools.cached_property
    def channels(self) -> tuple[str, ...]:
        """All channels, in block order."""
        return tuple(c for b in self.blocks for c in b.channels)

    @functools.cached_property
    def valid(self) -> np.ndarray:
        """Which samples are, of all blocks and channels in a row, shape (S,) bool."""
        return np.concatenate([(b.weight > 0.0).ravel() for b in self.blocks])

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


def trial_data(study: Study, shown: Container[str] | None = None) -> tuple[TrialData, ...]:
    """Every trial's output channels, grouped by stream and times; those that a model shows, if it says which."""
    return tuple(one_trial(study, study.recording(trial), shown) for trial in study.trials)


def one_trial(study: Study, recording: Recording, shown: Container[str] | None = None) -> TrialData:
    """As `trial_data`, of one recording that has some such channel."""
    groups: dict[tuple[str, bytes], list[str]] = {}
    for name, series in recording.items():
        if series.use == "output" and (shown is None or name in shown):
            groups.setdefault((series.stream, series.time.tobytes()), []).append(name)
    blocks = []
    for (stream, _), names in groups.items():
        time = recording[names[0]].time
        value = np.array([np.where(recording[n].valid, recording[n].value, 0.0) for n in names])
        weight = np.array([recording[n].valid / recording[n].sigma for n in names])
        blocks.append(Block(stream, tuple(names), time, value, weight))
    begin = min(b.time[0] for b in blocks)
    end = max(b.time[-1] for b in blocks)
    trial = recording.trial
    return TrialData(trial.id, study.condition(trial), trial.overrides, tuple(blocks), begin, end)
