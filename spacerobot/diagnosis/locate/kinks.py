"""When a body was knocked: what a model leaves over of its track is bent at a moment, and nowhere else.

A knock changes momentum at once, so each coordinate's residual has a corner there, a slope that jumps of a position or
a step of a rate, and is smooth before and after. What is left out of the model everywhere bends the residual smoothly:
a polynomial with as many coefficients is the rival that a corner must beat, and the same corner rounded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.special import fdtrc

from spacerobot.diagnosis.fitting.noise import common_level, correlation_time
from spacerobot.diagnosis.machines.touch import Moment

MOMENTS = 48
"""Moments that are tried first, evenly over a track."""

MARGIN = 0.04
"""Share of a track at either end in which no corner can be told from its start."""

FINER = 10
"""Moments to either side that are tried between neighbours of the first."""

ROUNDS = 3
"""Times that each corner is placed anew beside the others."""

FALL = 0.3
"""Share of the rms left over by which a corner lowers it: an effect size, for any smooth defect is bent somewhere."""

CHANCE = 1e-3
"""Probability with which a corner that is none falls so far at one of the moments tried (F test, Sidak)."""

ROUND = 0.1
"""Half the width of a rounded corner, as a share of the track: what does as well with it, or would last as long, is
smooth. Of a push that lasts, its own width.
"""

WIDTHS = 10
"""Lengths of a push that are tried, evenly up to that."""

FAINT = 0.02
"""Share of the rms of all tracks below which what is left over of one is as good as nothing."""

SHARPEST = 1e-9
"""Half the width [s] of a corner that is not rounded."""

MOST = 4
"""Corners of a track, at most."""

LEVEL = np.array([0.025, 0.5, 0.975])
"""Ends and middle of the interval of a moment."""


@dataclass(frozen=True, eq=False)
class Track:
    """What is left over of one channel. T readings.

    Attributes:
        time: shape (T,) [s].
        rest: weighted residual, shape (T,).
        rate: whether the channel is a velocity.
    """

    time: np.ndarray
    rest: np.ndarray
    rate: bool = False

    @cached_property
    def brought(self) -> float:
        """Sum of squares of what is left over, before any corner."""
        return float(np.square(self.rest).sum())


@dataclass(frozen=True)
class _Break:
    """What happens to all tracks at one moment: a corner, or (`step`) a jump of the readings that no body can make.

    A corner that lasts, by `half` [s] to either side of its moment, is a steady push.
    """

    time: float
    step: bool = False
    half: float = SHARPEST

    @property
    def lasts(self) -> float:
        """How long [s]; nothing where it is sharp."""
        return 2.0 * self.half if self.half > SHARPEST else 0.0


def kinks(tracks: Sequence[Track]) -> tuple[Moment, ...]:
    """The moments at which all tracks together are bent sharply, in order; none where a smooth curve does as well.

    Corners that would do as well rounded stand for what is smooth and was left out, beside the knocks. Steps of a
    position stand for a tracker that lost its body and found it elsewhere: two corners in a row would imitate one.
    """
    start, end = min(float(t.time[0]) for t in tracks), max(float(t.time[-1]) for t in tracks)
    grid = start + (end - start) * np.linspace(MARGIN, 1.0 - MARGIN, MOMENTS)
    found: list[_Break] = []
    known: list[_Break] = []
    accepted = _left(tracks, [])
    for count in range(1, MOST + 1):
        found = _lasting(tracks, _with_one_more(tracks, found, grid))
        square = _left(tracks, found)
        fall = 1.0 - float(np.sqrt(square / max(accepted, 1e-300)))
        large = fall > 1.0 - (1.0 - FALL) ** (count - len(known))
        better = large and square < _smooth(tracks, count) and _significant(tracks, known, found)
        if better and any(_sharp(tracks, found, k) for k in range(count)):
            known, accepted = list(found), square
    known = _with_steps(tracks, known, 2.0 * MARGIN * (end - start))
    corners = [k for k, one in enumerate(known) if not one.step and _sharp(tracks, known, k)]
    return tuple(sorted((_moment(tracks, known, k) for k in corners), key=lambda m: m.time))


def _with_steps(tracks: Sequence[Track], breaks: Sequence[_Break], near: float) -> list[_Break]:
    """The breaks, a step in place of each run of corners closer than this [s] where that costs less."""
    out = sorted(breaks, key=lambda one: one.time)
    if all(t.rate for t in tracks):
        return out
    k = 0
    while k < len(out):
        run = 1
        while k + run < len(out) and out[k + run].time - out[k + run - 1].time < near:
            run += 1
        places = np.linspace(out[k].time - 0.5 * near, out[k + run - 1].time + 0.5 * near, 4 * FINER + 1)
        step = _moved(tracks, [*out[:k], _Break(out[k].time, step=True), *out[k + run :]], k, places)
        if _cheapest(tracks, [out, step]) is step:
            out, run = step, 1
        k += run
    return out


def _with_one_more(tracks: Sequence[Track], found: Sequence[_Break], grid: np.ndarray) -> list[_Break]:
    """The corners with the best further one, each of them then moved to where it does best beside the others."""
    out = _moved(tracks, [*found, _Break(float(grid[0]))], len(found), grid)
    for _ in range(ROUNDS):
        for k in range(len(out)):
            out = _moved(tracks, out, k, grid)
    finer = float(grid[1] - grid[0]) * np.linspace(-1.0, 1.0, 2 * FINER + 1)
    for k in range(len(out)):
        out = _moved(tracks, out, k, np.clip(out[k].time + finer, grid[0], grid[-1]))
    return out


def _lasting(tracks: Sequence[Track], breaks: Sequence[_Break]) -> list[_Break]:
    """The breaks, each corner as a push that lasts where that costs less; what would last longest of all is smooth."""
    out = list(breaks)
    halves = ROUND * _length(tracks) * np.linspace(0.0, 1.0, WIDTHS + 1)[1:]
    shifts = np.linspace(-1.0, 1.0, WIDTHS - 1)  # of its own half: the corner lies somewhere in it
    for k, one in enumerate(breaks):
        pushes = [_Break(float(one.time + by * w), half=float(w)) for w in halves for by in shifts]
        best = min((_with(out, k, push) for push in pushes), key=lambda some: _left(tracks, some))
        if best[k].half < halves[-1]:
            out = _cheapest(tracks, [out, best])
    return out


def _length(tracks: Sequence[Track]) -> float:
    return max(float(t.time[-1] - t.time[0]) for t in tracks)


def _moved(tracks: Sequence[Track], breaks: Sequence[_Break], which: int, places: np.ndarray) -> list[_Break]:
    """The breaks with one of them where it does best among these places."""
    sets = [_at(breaks, which, float(p)) for p in places]
    return min(sets, key=lambda some: _left(tracks, some))


def _at(breaks: Sequence[_Break], which: int, time: float) -> list[_Break]:
    return _with(breaks, which, replace(breaks[which], time=time))


def _with(breaks: Sequence[_Break], which: int, one: _Break) -> list[_Break]:
    return [*breaks[:which], one, *breaks[which + 1 :]]


def _columns(track: Track, breaks: Sequence[_Break], rounded: int | None = None, width: float = 0.0) -> np.ndarray:
    """A track's own start and bend, and what its breaks bring, shape (T, 3 + 2 corners + steps).

    At each corner another slope and another bend: what resists the body resists it otherwise after a knock. Of a rate
    all are a degree lower, shape (T, 2 + 2 corners), and a step of the position is nothing. One of the corners may be
    rounded.
    """
    t = track.time - track.time[0]
    columns = [np.ones_like(t), t] if track.rate else [np.ones_like(t), t, t**2]
    for k, one in enumerate(breaks):
        after, w = track.time - one.time, width if k == rounded else one.half
        if one.step:
            if not track.rate:
                columns.append((after > 0.0).astype(float))
            continue
        ramp = np.where(np.abs(after) < w, (after + w) ** 2 / (4.0 * w), np.maximum(after, 0.0))
        columns += [np.clip(0.5 + 0.5 * after / w, 0.0, 1.0), ramp] if track.rate else [ramp, ramp**2]
    return np.stack(columns, axis=1)


def _coefficients(tracks: Sequence[Track], breaks: Sequence[_Break]) -> int:
    """Numbers that breaks set free in all tracks: the moments, how long they last, and what each brings."""
    lasting = sum(one.lasts > 0.0 for one in breaks)
    return len(breaks) + lasting + sum((not t.rate) if one.step else 2 for one in breaks for t in tracks)


def _cheapest(tracks: Sequence[Track], sets: Sequence[list[_Break]]) -> list[_Break]:
    """The breaks of least cost by Schwarz's criterion, at readings that are independent beside those that fit best."""
    closest = min(sets, key=lambda some: _left(tracks, some))
    independent = _independent(tracks, closest)

    def price(some: list[_Break]) -> float:
        square = max(_left(tracks, some), 1e-300)
        return independent * float(np.log(square)) + _coefficients(tracks, some) * float(np.log(independent))

    return min(sets, key=price)


def _independent(tracks: Sequence[Track], breaks: Sequence[_Break]) -> float:
    """Readings that are independent in what these breaks leave over."""
    rest = [_rest(t, _columns(t, breaks)) for t in tracks]
    return float(sum(r.size / correlation_time(r) for r in rest))


def _rest(track: Track, columns: np.ndarray) -> np.ndarray:
    found, *_ = np.linalg.lstsq(columns, track.rest, rcond=None)
    return np.asarray(track.rest - columns @ found)


def _left(tracks: Sequence[Track], breaks: Sequence[_Break], rounded: int | None = None, width: float = 0.0) -> float:
    """What these breaks leave over, as squares of all readings, each track by its own."""
    return _together(tracks, [_rest(t, _columns(t, breaks, rounded, width)) for t in tracks])


def _together(tracks: Sequence[Track], rests: Sequence[np.ndarray]) -> float:
    """Squares of all readings as if all tracks left over as much; what is FAINT beside what they brought is nothing."""
    counts = np.array([float(r.size) for r in rests])
    least = FAINT**2 * sum(t.brought for t in tracks) / float(counts.sum())
    return float(counts.sum()) * common_level(np.array([float(r @ r) for r in rests]), counts, least)


def _smooth(tracks: Sequence[Track], count: int) -> float:
    """What polynomials with no fewer coefficients than so many corners and their moments leave over."""
    rests = []
    for track in tracks:
        span = track.time[-1] - track.time[0]
        x = 2.0 * (track.time - track.time[0]) / max(float(span), 1e-300) - 1.0
        degree = 3 * count + (1 if track.rate else 2)
        rests.append(_rest(track, np.polynomial.legendre.legvander(x, degree)))
    return _together(tracks, rests)


def _significant(tracks: Sequence[Track], known: Sequence[_Break], found: Sequence[_Break]) -> bool:
    """Whether further breaks lower the squares by more than chance would."""
    further = _coefficients(tracks, found) - _coefficients(tracks, known)
    limit = 1.0 - (1.0 - CHANCE) ** (1.0 / MOMENTS)
    return bool(_chance(tracks, found, _left(tracks, known), further) < limit)


def _sharp(tracks: Sequence[Track], found: Sequence[_Break], which: int) -> bool:
    """Whether a corner fits better than the same one rounded does, by more than chance would have it."""
    width = max(ROUND * _length(tracks), found[which].lasts)
    return _chance(tracks, found, _left(tracks, found, which, width), len(tracks)) < CHANCE


def _chance(tracks: Sequence[Track], found: Sequence[_Break], other: float, further: int) -> float:
    """Probability (F) of as large an excess of other squares over those of the breaks, at independent readings."""
    after = _left(tracks, found)
    own = sum(_columns(t, []).shape[1] for t in tracks)
    spare = _independent(tracks, found) - own - _coefficients(tracks, found)
    if spare < 1.0 or other <= after:
        return 1.0
    return float(fdtrc(further, spare, (other - after) / further / max(after / spare, 1e-300)))


def _moment(tracks: Sequence[Track], breaks: Sequence[_Break], which: int) -> Moment:
    """One of the corners with its 95 % interval and all of its push, the other breaks in their places."""
    start, end = min(float(t.time[0]) for t in tracks), max(float(t.time[-1]) for t in tracks)
    half = (end - start) / MOMENTS
    near = breaks[which].time + half * np.linspace(-1.0, 1.0, 10 * FINER + 1)
    low, middle, high = _interval(tracks, [_at(breaks, which, float(m)) for m in near], near)
    lasts = breaks[which].lasts
    if lasts == 0.0:
        return Moment(middle, low, high)
    halves = np.linspace(0.0, lasts, 10 * FINER + 1)[1:]
    sets = [_with(breaks, which, replace(breaks[which], half=float(h))) for h in halves]
    shortest, long, longest = (2.0 * h for h in _interval(tracks, sets, halves))
    return Moment(middle, low - 0.5 * longest, high + 0.5 * longest, (long, shortest, longest))


def _interval(tracks: Sequence[Track], sets: Sequence[list[_Break]], values: np.ndarray) -> tuple[float, float, float]:
    """Ends and middle of the 95 % interval of a value, evenly spaced, by what the breaks with each leave over."""
    squares = np.array([_left(tracks, some) for some in sets])
    return likely(squares, _independent(tracks, sets[int(np.argmin(squares))]), values)


def likely(squares: np.ndarray, independent: float, values: np.ndarray) -> tuple[float, float, float]:
    """Ends and middle of the 95 % interval of a value, each counted by its likelihood.

    Args:
        squares: what is left over with each value, shape (M,).
        independent: readings.
        values: evenly spaced, shape (M,).
    """
    weight = (max(float(squares.min()), 1e-300) / np.maximum(squares, 1e-300)) ** (0.5 * independent)
    low, middle, high = np.interp(LEVEL, np.cumsum(weight) / weight.sum(), values)
    return float(low), float(middle), float(high)
