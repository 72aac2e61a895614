"""The free approach: before a target touches the wrist it drifts, the wrist rests and the force sensor reads nothing.

That stretch says which way the target travels, what noise and zero each sensor has, and when and where they touch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.recordings.series import estimate_noise
from spacerobot.recordings.table import Floats

CLEAR = 6.0
"""Sigmas by which a reading leaves its rest: fewer than one in 1e8 of Gaussian readings does by chance."""

CERTAIN = 3.0
"""Standard errors within which a zero is taken for zero."""

STRAIGHT = 1.5
"""Times its noise that a track may scatter about a line and still be taken to keep to it."""

FEWEST = 8
"""Samples of an approach: the noise estimate needs as many."""


@dataclass(frozen=True)
class Track:
    """A sensor's readings in one trial, as they stand in the file.

    Attributes:
        time: (n,) s, increasing.
        value: (n,) finite, in the file's unit.
    """

    time: Floats
    value: Floats


@dataclass(frozen=True)
class Rest:
    """A sensor that rests and then moves.

    Attributes:
        zero: its reading at rest, file's unit.
        error: standard error of `zero`.
        sigma: its noise, file's unit.
        leaves: when it leaves its rest, s; None where it never does.
        sign: +1 where its first movement grows, -1 where it falls.
        step: from one sample to the next, s.
    """

    zero: float
    error: float
    sigma: float
    leaves: float | None
    sign: int
    step: float


def rest(track: Track) -> Rest | None:
    """The rest that a track begins with; None where it is too short or moves from the start."""
    sigma = estimate_noise(track.value)
    if not sigma > 0 or len(track.value) < 2 * FEWEST:
        return None
    zero = float(np.median(track.value[: max(FEWEST, len(track.value) // 20)]))
    # A sample is out where it and the next lie beyond on the same side: one alone may be a slip of the sensor.
    beyond = np.sign(track.value - zero) * (np.abs(track.value - zero) > CLEAR * sigma)
    out = np.flatnonzero((beyond[:-1] != 0) & (beyond[:-1] == beyond[1:]))
    if len(out) and out[0] < FEWEST:
        return None
    end = int(out[0]) if len(out) else len(track.value)
    still = track.value[: max(FEWEST, end - max(2, end // 20))]
    error = float(1.2533 * sigma / np.sqrt(len(still)))  # of a median of Gaussian readings
    leaves = float(track.time[end]) if len(out) else None
    step = float(np.median(np.diff(track.time)))
    return Rest(float(np.median(still)), error, sigma, leaves, int(beyond[end]) if len(out) else 1, step)


@dataclass(frozen=True)
class Drift:
    """A body that drifts freely, as a line through its readings.

    Attributes:
        velocity: file's unit per second, one per axis.
        sigma: noise of each axis, file's unit.
        start, end: the stretch, s.
    """

    velocity: tuple[float, ...]
    sigma: tuple[float, ...]
    start: float
    end: float


def drift(axes: Sequence[Track], until: float | None) -> Drift | None:
    """The free drift of a body up to the time `until`, or, where none is known, as long as it goes straight."""
    time = axes[0].time
    end = until if until is not None else _straight(axes)
    within = time < end - 0.02 * (end - time[0])
    if within.sum() < FEWEST:
        return None
    velocity = tuple(float(np.polyfit(a.time[within] - time[0], a.value[within], 1)[0]) for a in axes)
    return Drift(velocity, tuple(estimate_noise(a.value) for a in axes), float(time[0]), end)


def _straight(axes: Sequence[Track]) -> float:
    """Until when every axis keeps to a line: of the first third, its halves, and so on the longest that does."""
    time = axes[0].time
    for share in (3, 6, 12, 24):
        end = float(time[0] + (time[-1] - time[0]) / share)
        within = time < end
        if within.sum() < 2 * FEWEST:
            break
        t = time[within] - time[0]
        bent = (float(np.std(a.value[within] - np.polyval(np.polyfit(t, a.value[within], 1), t))) for a in axes)
        if all(b <= STRAIGHT * estimate_noise(a.value) for b, a in zip(bent, axes, strict=True)):
            return end
    return float(time[0] + (time[-1] - time[0]) / 3)


def straight(track: Track, start: float, limit: float, *, back: bool = False) -> float:
    """How far from `start` towards `limit` a track keeps to a line.

    Args:
        track: readings.
        start, limit: times, s.
        back: whether `limit` is before `start`.
    """
    sigma = estimate_noise(track.value)
    for share in np.linspace(1.0, 0.02, 50):
        end = start + share * (limit - start)
        inside = (track.time >= end) & (track.time <= start) if back else (track.time >= start) & (track.time <= end)
        if inside.sum() < FEWEST:
            break
        t = track.time[inside] - start
        bent = track.value[inside] - np.polyval(np.polyfit(t, track.value[inside], 1), t)
        if float(np.std(bent)) <= STRAIGHT * sigma:
            return float(end)
    return float(start)


def crest(track: Track, height: float) -> float | None:
    """When a track turns back at its highest, by a parabola through the upper half of its last `height`.

    None where it does not turn back within the track.
    """
    top = int(np.argmax(track.value))
    low = np.flatnonzero(track.value <= track.value[top] - height / 2)
    before, after = low[low < top], low[low > top]
    if not len(before) or not len(after):
        return None
    window = slice(int(before[-1]) + 1, int(after[0]))
    if window.stop - window.start < FEWEST:
        return None
    t = track.time[window] - track.time[top]
    bend, slope, _ = np.polyfit(t, track.value[window], 2)
    return float(track.time[top] - slope / (2 * bend)) if bend < 0 else None


def contact_zero(target: Track, wrist: Track, wrist_rest: Rest, sign: int) -> tuple[float, float] | None:
    """The target's reading where it first touches the resting wrist, and its standard error; file's unit.

    While the wrist is pushed in, target and wrist move together but for the contact's own give, which grows with the
    wrist's spring and so with its displacement: the line of their difference over that displacement meets its zero
    where they touch. Readings three scatters off it have let go of each other and are left out.

    Args:
        target: readings along the direction of travel, of one length unit with the wrist's.
        wrist: readings along the same axis.
        wrist_rest: its rest.
        sign: +1 where readings grow along the travel.
    """
    if wrist_rest.leaves is None:
        return None
    pushed = sign * (np.interp(target.time, wrist.time, wrist.value) - wrist_rest.zero)
    gap = sign * target.value - pushed
    after = target.time >= wrist_rest.leaves
    peak = float(pushed[after].max(initial=0.0))
    after &= np.cumsum(after & (pushed > 0.8 * peak)) > 0  # knocked away at first, it is caught again by then
    first_back = np.flatnonzero(after & (pushed < 0.15 * peak))
    together = after & (np.arange(len(pushed)) < (first_back[0] if len(first_back) else len(pushed)))
    if together.sum() < FEWEST or not peak > CLEAR * wrist_rest.sigma:
        return None
    x, y = pushed[together], gap[together]
    for _ in range(4):
        slope, zero = np.polyfit(x, y, 1)
        left = y - slope * x - zero
        kept = np.abs(left) <= 3 * float(np.median(np.abs(left))) / 0.6745
        if kept.all():
            break
        x, y = x[kept], y[kept]
    if len(x) <= FEWEST // 2:
        return None
    covariance = np.linalg.inv(np.array([[x @ x, x.sum()], [x.sum(), len(x)]]))
    scatter = float(np.std(y - slope * x - zero, ddof=2))
    return sign * float(zero), scatter * float(np.sqrt(covariance[1, 1]))
