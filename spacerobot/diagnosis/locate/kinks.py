"""When a body was knocked: what a model leaves over of its track is bent at a moment, and nowhere else.

A knock changes momentum at once, so each coordinate's residual has a corner there, a slope that jumps of a position or
a step of a rate, and is smooth before and after. What is left out of the model everywhere bends the residual smoothly:
a polynomial with as many coefficients is the rival that a corner must beat, and the same corner rounded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc

from spacerobot.diagnosis.fitting.noise import correlation_time
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
"""Half the width of a rounded corner, as a share of the track: what does as well with it was a push that lasted."""

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


def kinks(tracks: Sequence[Track]) -> tuple[Moment, ...]:
    """The moments at which all tracks together are bent sharply, in order; none where a smooth curve does as well.

    Corners that would do as well rounded stand for what is smooth and was left out, beside the knocks.
    """
    start, end = min(float(t.time[0]) for t in tracks), max(float(t.time[-1]) for t in tracks)
    grid = start + (end - start) * np.linspace(MARGIN, 1.0 - MARGIN, MOMENTS)
    found: list[float] = []
    known: list[float] = []
    sharp: list[int] = []
    accepted = _left(tracks, [])
    for count in range(1, MOST + 1):
        found = _with_one_more(tracks, found, grid)
        square = _left(tracks, found)
        fall = 1.0 - float(np.sqrt(square / max(accepted, 1e-300)))
        large = fall > 1.0 - (1.0 - FALL) ** (count - len(known))
        if large and square < _smooth(tracks, count) and _significant(tracks, known, found):
            some = [k for k in range(count) if _sharp(tracks, found, k)]
            if some:
                known, sharp, accepted = list(found), some, square
    return tuple(sorted((_moment(tracks, known, k) for k in sharp), key=lambda m: m.time))


def _with_one_more(tracks: Sequence[Track], found: Sequence[float], grid: np.ndarray) -> list[float]:
    """The corners with the best further one, each of them then moved to where it does best beside the others."""
    out = _moved(tracks, [*found, float(grid[0])], len(found), grid)
    for _ in range(ROUNDS):
        for k in range(len(out)):
            out = _moved(tracks, out, k, grid)
    finer = float(grid[1] - grid[0]) * np.linspace(-1.0, 1.0, 2 * FINER + 1)
    for k in range(len(out)):
        out = _moved(tracks, out, k, np.clip(out[k] + finer, grid[0], grid[-1]))
    return out


def _moved(tracks: Sequence[Track], moments: Sequence[float], which: int, places: np.ndarray) -> list[float]:
    """The corners with one of them where it does best among these places."""
    sets = [[*moments[:which], float(p), *moments[which + 1 :]] for p in places]
    return min(sets, key=lambda some: _left(tracks, some))


def _columns(track: Track, moments: Sequence[float], rounded: int | None = None, width: float = 0.0) -> np.ndarray:
    """A track's own start and bend, and at each corner another slope and another bend, shape (T, 3 + 2 K).

    What resists the body resists it otherwise after a knock. Of a rate all are a degree lower, shape (T, 2 + 2 K). One
    of the corners may be rounded.
    """
    t = track.time - track.time[0]
    after = [track.time - m for m in moments]
    widths = [width if k == rounded else SHARPEST for k in range(len(moments))]
    ramps = [
        np.where(np.abs(a) < w, (a + w) ** 2 / (4.0 * w), np.maximum(a, 0.0))
        for a, w in zip(after, widths, strict=True)
    ]
    if track.rate:
        steps = [np.clip(0.5 + 0.5 * a / w, 0.0, 1.0) for a, w in zip(after, widths, strict=True)]
        return np.stack([np.ones_like(t), t, *steps, *ramps], axis=1)
    return np.stack([np.ones_like(t), t, t**2, *ramps, *(r**2 for r in ramps)], axis=1)


def _rest(track: Track, columns: np.ndarray) -> np.ndarray:
    found, *_ = np.linalg.lstsq(columns, track.rest, rcond=None)
    return np.asarray(track.rest - columns @ found)


def _left(tracks: Sequence[Track], moments: Sequence[float]) -> float:
    """Sum of squares that corners at these moments leave over."""
    return sum(float(np.square(_rest(t, _columns(t, moments))).sum()) for t in tracks)


def _smooth(tracks: Sequence[Track], count: int) -> float:
    """What polynomials with no fewer coefficients than so many corners and their moments leave over."""
    total = 0.0
    for track in tracks:
        span = track.time[-1] - track.time[0]
        x = 2.0 * (track.time - track.time[0]) / max(float(span), 1e-300) - 1.0
        degree = 3 * count + (1 if track.rate else 2)
        total += float(np.square(_rest(track, np.polynomial.legendre.legvander(x, degree))).sum())
    return total


def _significant(tracks: Sequence[Track], known: Sequence[float], found: Sequence[float]) -> bool:
    """Whether further corners lower the squares by more than chance would."""
    further = (2 * len(tracks) + 1) * (len(found) - len(known))
    limit = 1.0 - (1.0 - CHANCE) ** (1.0 / MOMENTS)
    return bool(_chance(tracks, found, _left(tracks, known), further) < limit)


def _sharp(tracks: Sequence[Track], found: Sequence[float], which: int) -> bool:
    """Whether a corner fits better than the same one rounded does, by more than chance would have it."""
    width = ROUND * max(float(t.time[-1] - t.time[0]) for t in tracks)
    rounded = sum(float(np.square(_rest(t, _columns(t, found, which, width))).sum()) for t in tracks)
    return _chance(tracks, found, rounded, len(tracks)) < CHANCE


def _chance(tracks: Sequence[Track], found: Sequence[float], other: float, further: int) -> float:
    """Probability (F) of as large an excess of other squares over those of the corners, at independent readings."""
    after = _left(tracks, found)
    spare = -float(len(found))
    for track in tracks:
        columns = _columns(track, found)
        spare += track.time.size / correlation_time(_rest(track, columns)) - columns.shape[1]
    if spare < 1.0 or other <= after:
        return 1.0
    return float(fdtrc(further, spare, (other - after) / further / max(after / spare, 1e-300)))


def _moment(tracks: Sequence[Track], moments: Sequence[float], which: int) -> Moment:
    """One of the corners with its 95 % interval, the others in their places."""
    others = [m for k, m in enumerate(moments) if k != which]
    start, end = min(float(t.time[0]) for t in tracks), max(float(t.time[-1]) for t in tracks)
    half = (end - start) / MOMENTS
    near = moments[which] + half * np.linspace(-1.0, 1.0, 10 * FINER + 1)
    squares = np.array([_left(tracks, [*others, float(m)]) for m in near])
    rest = [_rest(t, _columns(t, moments)) for t in tracks]
    independent = sum(r.size / correlation_time(r) for r in rest)
    weight = (max(float(squares.min()), 1e-300) / np.maximum(squares, 1e-300)) ** (0.5 * independent)
    low, middle, high = np.interp(LEVEL, np.cumsum(weight) / weight.sum(), near)
    return Moment(float(middle), float(low), float(high))
