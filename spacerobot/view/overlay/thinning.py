"""Long records drawn with few points and no peak lost."""

from __future__ import annotations

import numpy as np


def envelope(time: np.ndarray, value: np.ndarray, points: int) -> tuple[np.ndarray, np.ndarray]:
    """At most about `points` samples of a record, the smallest and the largest of every stretch among them.

    Args:
        time, value: shape (T,); a NaN stays and breaks the line.
        points: 4 at least.

    Returns:
        time and value, shape (P,) each, in order.
    """
    if time.size <= points:
        return time, value
    kept = []
    for stretch in np.array_split(np.arange(time.size), max(2, points // 2)):
        good = stretch[np.isfinite(value[stretch])]
        if good.size < stretch.size:
            kept.append(stretch[~np.isfinite(value[stretch])][:1])
        if good.size:
            kept.append(good[[np.argmin(value[good]), np.argmax(value[good])]])
    index = np.unique(np.concatenate([[0, time.size - 1], *kept]))
    return time[index], value[index]


def extremes(points: int, *values: np.ndarray) -> np.ndarray:
    """Indices of at most about `points` samples, ascending: the least and the largest of every stretch of each record.

    Args:
        points: 4 at least.
        values: shape (T,) each.
    """
    size = values[0].size
    if size <= points:
        return np.arange(size)
    place = np.arange(float(size))
    kept = [envelope(place, v, max(4, points // len(values)))[0].astype(int) for v in values]
    return np.unique(np.concatenate(kept))


def broken(time: np.ndarray, value: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A record with a NaN before each of the times `at`, shape (R,), so that a line drawn through it breaks there."""
    inside = at[(at > time[0]) & (at <= time[-1])] if time.size else at[:0]
    index = np.searchsorted(time, inside)
    return np.insert(time, index, inside), np.insert(value, index, np.nan)
