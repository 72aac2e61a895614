"""Recorded channels on one even grid, and which of its points lie beside a reading."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from spacerobot.recordings.recording import Recording
from spacerobot.recordings.series import estimate_noise
from spacerobot.support.errors import InputError

GAP = 3.5
"""A hole of this many steps between readings is not bridged."""

BRIEF = 0.02
"""Nor is a hole [s] counted that is brief against the motion of any machine: clocks of fast logs jitter."""


ORDER = 6
"""Of the differences that show noise: a motion of a fifteenth of the log's rate leaves 0.02 % of itself in them."""


@dataclass(frozen=True, eq=False)
class Grid:
    """Channels of one recording at the same even times. T times, C channels."""

    time: np.ndarray  # (T,) s
    step: float  # s
    value: dict[str, np.ndarray]  # channel -> (T,)
    good: np.ndarray  # (T,) bool: no channel has a hole here

    @cached_property
    def scatter(self) -> dict[str, float]:
        """By channel, how it scatters from one sample to the next, whatever moves it: one standard deviation."""
        return {c: estimate_noise(x[self.good], ORDER) for c, x in self.value.items()}


def even_grid(recording: Recording, channels: Sequence[str]) -> Grid:
    """The channels interpolated linearly at the median spacing of the first, where all of them run.

    Raises:
        InputError: they never run at the same time.
    """
    pairs = {c: recording[c].good() for c in channels}
    first = pairs[channels[0]][0]
    step = float(np.median(np.diff(first)))
    begin = max(t[0] for t, _ in pairs.values())
    end = min(t[-1] for t, _ in pairs.values())
    if end - begin < 10 * step:
        raise InputError("channels hardly run at the same time", given=list(channels), where=recording.trial.where)
    time = begin + step * np.arange(int((end - begin) / step + 1e-6) + 1)
    good = np.ones(time.size, dtype=bool)
    value = {}
    for channel, (t, x) in pairs.items():
        value[channel] = np.interp(time, t, x)
        wide = np.diff(t) > max(GAP * step, GAP * float(np.median(np.diff(t))), BRIEF)
        for left, right in zip(t[:-1][wide], t[1:][wide], strict=True):
            good &= ~((time > left) & (time < right))
    return Grid(time, step, value, good)
