"""Where the clocks of a trial's streams begin beside one another: a touch shows in all of them at the same moment.

A fit then finds each clock's offset with everything else, as a number of the trial's own; contacts last milliseconds
and follow upon one another, so that it must begin within one of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.recordings.drafting.approach import Track, rest
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.series import Series
from spacerobot.support.errors import InputError

TRACK = "target.x"
"""Whose clock a trial is told on, and whose zero is the touch; without it a trial of a wrist has no start."""

SHOWN_BY = ("contact.force", "wrist.x", "hand.x")
"""Channels that rest until the touch, the sharpest first."""

LEAST = 4
"""Readings of the track before the touch, at least."""

NEAR = 5e-4
"""Distance from its zero [m] from which on the track counts no more as free: contacts give as much."""

EDGE = 0.01
"""Seconds at either end of the track that another clock's readings keep clear of: room for the offset to move in."""


@dataclass(frozen=True)
class Clocks:
    """How the clocks of a trial's streams are set beside one another.

    Attributes:
        reference: the clock that the trial is told on.
        late: by how much each other clock is first taken to be ahead of it [s]: what is taken off its times.
    """

    reference: str
    late: dict[str, float]

    def on_reference(self, series: Series) -> np.ndarray:
        """A series' times on the reference clock, as far as it is known, shape (n,) [s]."""
        return series.time - self.late.get(series.clock, 0.0)


def clocks_of(recording: Recording, names: Sequence[str]) -> Clocks:
    """Set the clocks of a trial's channels beside one another by the touch that all of them saw.

    Args:
        recording: the trial.
        names: its channels that a fit reads.

    Raises:
        InputError: a stream on a clock of its own does not show the touch, or the track does not; with stream and
            trial.
    """
    reference = recording[TRACK if TRACK in names else names[0]].clock
    others = dict.fromkeys(recording[n].clock for n in names if recording[n].clock != reference)
    if not others:
        return Clocks(reference, {})
    touch = touch_of_track(recording[TRACK]) if TRACK in names else None
    late = {}
    for clock in others:
        own = [recording[n] for n in names if recording[n].clock == clock]
        if touch is None:
            raise _lost(recording, own[0].stream, f"{TRACK} does not come free to its zero, the touch")
        seen = first_seen(own)
        if seen is None:
            listed = ", ".join(s.name for s in own)
            raise _lost(recording, own[0].stream, f"{listed}: no rest that ends with a touch")
        late[clock] = seen - touch
    return Clocks(reference, late)


def within(series: Series, time: np.ndarray, span: tuple[float, float]) -> Series:
    """A series of another clock at these times, less what the track did not see: nothing else says when that was."""
    kept = (time > span[0] + EDGE) & (time < span[1] - EDGE)
    return replace(series, time=time[kept], value=series.value[kept], valid=series.valid[kept])


def touch_of_track(track: Series) -> float | None:
    """When the free approach comes to zero [s]; None where it never does, or begins there."""
    time, value = track.good()
    near = np.flatnonzero(value > -NEAR)
    if not near.size or near[0] < LEAST:
        return None
    slope, offset = np.polyfit(time[: near[0]] - time[0], value[: near[0]], 1)
    if not slope > 0.0:
        return None
    return float(time[0] - offset / slope)


def first_seen(series: Sequence[Series]) -> float | None:
    """When the first touch shows in channels that rest until then [s]; None where none does."""
    for name in SHOWN_BY:
        for one in series:
            if one.name != name or one.valid.sum() < LEAST:
                continue
            time, value = one.good()
            still = rest(Track(time, value))
            if still is None or still.leaves is None:
                continue
            return still.leaves - (0.0 if name == "contact.force" else _since(time, value - still.zero, still.leaves))
    return None


def _since(time: np.ndarray, moved: np.ndarray, leaves: float) -> float:
    """For how long a slider has been moving when it is first seen to: back along the way that it then goes [s]."""
    start = int(np.searchsorted(time, leaves))
    away = np.abs(moved[start:])
    peak = int(np.argmax(away >= 0.5 * away.max()))
    rows = slice(start, start + max(peak, 2))
    slope, offset = np.polyfit(time[rows] - leaves, np.abs(moved[rows]), 1)
    return float(max(offset / slope, 0.0)) if slope > 0.0 else 0.0


def _lost(recording: Recording, stream: str, why: str) -> InputError:
    trial = recording.trial
    return InputError(
        f"the offset of stream {stream}'s own clock cannot be found in trial {trial.id}",
        given=why,
        valid=f"a trial whose touch {stream} and the track both show; or streams on one clock, with time_offset",
        where=trial.where,
    )
