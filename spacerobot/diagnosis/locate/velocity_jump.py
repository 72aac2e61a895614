"""When a velocity changed abruptly: straight on before, straight on after, and a short ramp between the two."""

from __future__ import annotations

import numpy as np

from spacerobot.diagnosis.fitting.noise import correlation_time
from spacerobot.diagnosis.locate.kinks import likely
from spacerobot.diagnosis.machines.touch import Moment

SIDE = 0.5
"""Length [s] of the straight parts."""

LONGEST = 0.3
"""Longest ramp [s] that is called abrupt."""

FINE = 0.005
"""Readings are put together in bins of this length [s]."""

COARSE = 4
"""Bins between the moments that are tried first."""

CLEAR = 5.0
"""A jump has at least so many times the scatter about the straight parts."""

LARGE = 0.3
"""And at least this share of the range of all that was recorded: an effect size."""


def jump(time: np.ndarray, velocity: np.ndarray) -> Moment | None:
    """The moment at which the clearest jump begins; None where there is none. Both shape (T,)."""
    t, y = _binned(time, velocity)
    side, longest = round(SIDE / FINE), round(LONGEST / FINE)
    if t.size < 2 * side + longest:
        return None
    clearest, at, ramp = 0.0, 0, 0
    for length in range(0, longest + 1, 2 * COARSE):
        for first in range(side, t.size - side - length, COARSE):
            size, scatter = _gap(t, y, first, length, side)
            if size > LARGE * np.ptp(y) and size > clearest * scatter:
                clearest, at, ramp = size / max(scatter, 1e-300), first, length
    if clearest < CLEAR:
        return None
    return _begin(t, y, at, ramp, side)


def _binned(time: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    grid = np.arange(time[0], time[-1], FINE)
    cell = np.minimum(((time - time[0]) / FINE).astype(int), grid.size - 1)
    count = np.bincount(cell, minlength=grid.size)
    some = count > 0
    total = np.bincount(cell, value, minlength=grid.size)
    middle = grid + 0.5 * FINE
    return middle, np.interp(middle, middle[some], total[some] / count[some])


def _gap(t: np.ndarray, y: np.ndarray, first: int, length: int, side: int) -> tuple[float, float]:
    """How far the two lines are apart in the middle of the ramp, and the scatter about them."""
    x = (np.arange(side) - 0.5 * (side - 1)) * FINE
    reach = (0.5 * (side - 1) + 0.5 * (length + 1)) * FINE
    before, after = y[first - side : first], y[first + length : first + length + side]
    slope = [float(x @ part) / float(x @ x) for part in (before, after)]
    mean = [float(part.mean()) for part in (before, after)]
    rest = [part - m - s * x for part, m, s in zip((before, after), mean, slope, strict=True)]
    scatter = float(np.sqrt(sum(r @ r for r in rest) / (2 * side - 4)))
    return abs((mean[1] - slope[1] * reach) - (mean[0] + slope[0] * reach)), scatter


def _begin(t: np.ndarray, y: np.ndarray, at: int, ramp: int, side: int) -> Moment:
    """Where the ramp begins, by least squares over beginnings and ends, with its 95 % interval."""
    part = slice(max(at - side, 0), min(at + ramp + side, t.size))
    x, value = t[part] - t[at], y[part]
    lengths = np.arange(1, 2 * round(LONGEST / FINE) + 1) * FINE
    begins = np.arange(-round(LONGEST / FINE), ramp + 1) * FINE
    best = np.full(begins.size, np.inf)
    rest = value
    for k, begin in enumerate(begins):
        for length in lengths[::2]:
            share = np.clip((x - begin) / length, 0.0, 1.0)
            after = np.maximum(x - begin - length, 0.0)
            columns = np.stack([np.ones_like(x), np.minimum(x - begin, 0.0), share, after], axis=1)
            found, *_ = np.linalg.lstsq(columns, value, rcond=None)
            left = value - columns @ found
            square = float(left @ left)
            if square < best[k]:
                if square < best.min():
                    rest = left
                best[k] = square
    independent = max(value.size / correlation_time(rest), 5.0)
    low, middle, high = likely(best, independent, begins + 0.5 * FINE)
    return Moment(float(t[at] + middle), float(t[at] + low - 0.5 * FINE), float(t[at] + high + 0.5 * FINE))
