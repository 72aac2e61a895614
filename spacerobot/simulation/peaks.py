"""The largest value of something on a run's dense solution, whenever it occurs: no clock of samples can miss it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

CANDIDATES = 6
"""Highest samples whose surroundings are searched: neighbours of one top, and tops as good as equal."""

NARROWING, ROUNDS = 8, 9
"""A bracket is parted into so many, and the best two kept, so many times: to 4^-9 of it, 1e-11 of the value."""


@dataclass(frozen=True)
class Peak:
    """A largest value and when it was reached; NaN where it never was.

    Attributes:
        value: in the quantity's unit.
        time: [s].
    """

    value: float
    time: float


UNKNOWN = Peak(math.nan, math.nan)
"""Of runs that were saved before peaks were."""


class Pressing(Protocol):
    """A finished run of either backend, as peaks need it."""

    @property
    def pieces(self) -> int:
        """Pieces of a step, at whose ends a quantity is looked at, in each of which it turns once at most."""

    def boundaries(self) -> np.ndarray:
        """Times of all step ends, shape (m + 1,) [s]."""

    def pressed(self) -> np.ndarray:
        """Whether the contact carries force in each step, shape (m,)."""

    def contact_at(self, times: np.ndarray) -> np.ndarray:
        """Contact force, positive in compression, shape (T,) [N]."""

    def deflection_at(self, times: np.ndarray) -> np.ndarray:
        """Of the wrist, positive pushed in, shape (T,) [m]."""


def peak_force(run: Pressing) -> Peak:
    """Largest contact force [N]; zero, at no time, if nothing ever pressed."""
    found = peak(run.contact_at, run.boundaries(), run.pressed(), run.pieces)
    return found if found.value > 0.0 else Peak(0.0, math.nan)


def peak_deflection(run: Pressing) -> Peak:
    """Furthest that the wrist was pushed in [m]."""
    ends = run.boundaries()
    return peak(run.deflection_at, ends, np.ones(ends.size - 1, dtype=bool), run.pieces)


def peak(of: Callable[[np.ndarray], np.ndarray], ends: np.ndarray, within: np.ndarray, pieces: int) -> Peak:
    """Largest value of a quantity that is smooth inside every step and may jump between two.

    Args:
        of: ascending times, shape (T,) -> values, shape (T,); at a step's end it is that of the step after.
        ends: of the steps, shape (m + 1,) [s].
        within: steps to look at, shape (m,).
        pieces: of a step, in each of which the quantity turns once at most.
    """
    index = np.flatnonzero(within & (np.diff(ends) > 0.0))
    if not index.size:
        return UNKNOWN
    start, stop = ends[index], np.nextafter(ends[index + 1], -np.inf)
    if index[-1] == ends.size - 2:
        stop[-1] = ends[-1]  # nothing comes after
    grid = start[:, None] + (stop - start)[:, None] * np.linspace(0.0, 1.0, pieces + 1)
    grid[:, -1] = stop
    values = of(grid.ravel()).reshape(grid.shape)
    best = int(values.argmax())
    top = Peak(float(values.flat[best]), float(grid.flat[best]))
    for flat in np.argsort(values, axis=None)[::-1][:CANDIDATES]:
        step, k = divmod(int(flat), pieces + 1)
        here, near = float(values[step, k]), float(values[step, max(k - 1, 0) : k + 2].min())
        if here + (here - near) < top.value:
            continue  # between three samples a top stands above the middle one by less than that above the lowest
        low, high = float(grid[step, max(k - 1, 0)]), float(grid[step, min(k + 1, pieces)])
        top = _narrowed(of, low, high, top)
    return top


def _narrowed(of: Callable[[np.ndarray], np.ndarray], low: float, high: float, top: Peak) -> Peak:
    """The higher of `top` and the largest value between two moments, around one of which it turns."""
    for _ in range(ROUNDS):
        times = np.linspace(low, high, NARROWING + 1)
        values = of(times)
        k = int(values.argmax())
        if values[k] > top.value:
            top = Peak(float(values[k]), float(times[k]))
        low, high = float(times[max(k - 1, 0)]), float(times[min(k + 1, NARROWING)])
    return top
