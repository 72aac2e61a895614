"""Readings that nothing around them leads to, told from whatever moves: touches, peaks and bends.

All of this is asked of the readings alone. A glitch is a reading that neither those before it, nor those after it, nor
those on both sides lead to; what bends a track, a touch or a peak, is led to by one of them.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

CHANCE = 1e-6
"""Probability that Gaussian noise of so many readings has one so far out."""

AROUND = ((-2, -1, 1, 2), (-2, -1, 2, 3), (-3, -2, 1, 2))
"""Places of the readings that a suspected one is compared with."""

SIDE = 5
"""Readings on one side that say where the next should be."""

MOST, LONGEST = 3, 20
"""Glitches that are told apart among suspected readings in a row, and how many of these there may be."""

LED_TO = 3.0
"""Standard errors within which a side leads to a reading: one step in 400 is beyond, and a glitch if it looks so."""

BENT = 27.6
"""chi-squared of two degrees of freedom that chance exceeds once in 1e6: what five readings may be off a parabola."""


def glitches(value: np.ndarray, sigma: float, pulses: bool = False) -> np.ndarray:
    """Readings that nothing around them leads to, shape (T,) bool.

    A reading is suspected that is not where the cubic through its neighbours has it, and so are then its neighbours. Of
    these the fewest are glitches without which those around are no longer suspected, if neither the readings before nor
    those after lead to them: a bend or a step is led to by one side.

    Args:
        value: shape (T,), in order of time, about evenly spaced.
        sigma: standard deviation of their noise.
        pulses: whether two readings in a row that are larger than all around them may be a pulse.
    """
    out = np.zeros(value.size, dtype=bool)
    if value.size < 4 * SIDE:
        return out
    far = float(norm.isf(CHANCE / (2.0 * value.size)))
    suspected = np.flatnonzero(_suspected(value, far * sigma))
    series = _Series(value, sigma, far, pulses)
    for rows in np.split(suspected, 1 + np.flatnonzero(np.diff(suspected) > SIDE)):
        if rows.size and rows[-1] - rows[0] < LONGEST:
            out[series.found(range(max(rows[0] - 1, 2), min(rows[-1] + 2, value.size - 2)))] = True
    for at in (1, 0, value.size - 2, value.size - 1):  # one side only, the inner one first
        inside = np.arange(at + 1, at + 1 + 2 * SIDE) if at < 2 else np.arange(at - 2 * SIDE, at)
        inside = inside[~out[inside]]
        off = _off(value, sigma, at, inside[:SIDE] if at < 2 else inside[::-1][:SIDE])
        out[at] |= off is not None and abs(off) > far
    return out


def _suspected(value: np.ndarray, limit: float) -> np.ndarray:
    """Which readings are further than a limit from the cubic through two to either side, shape (T,) bool.

    One's next neighbour is also left out of it, before or after: two glitches in a row hide each other.
    """
    out = np.zeros(value.size, dtype=bool)
    for around in AROUND:
        weights = _cubic(np.array(around))
        rows = np.arange(-around[0], value.size - around[-1])
        led = sum(w * value[rows + a] for w, a in zip(weights, around, strict=True))
        out[rows] |= np.abs(value[rows] - led) > limit * np.sqrt(1.0 + float(weights @ weights))
    return out


def _cubic(near: np.ndarray) -> np.ndarray:
    """Weights of four readings, at these places from another, in the cubic through them, there."""
    return np.linalg.solve(np.vander(near.astype(float), 4, increasing=True).T, [1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class _Series:
    """Readings of shape (T,), their noise, and by how many sigmas one must be off to be none of it."""

    value: np.ndarray
    sigma: float
    far: float
    pulses: bool

    def found(self, rows: Sequence[int]) -> list[int]:
        """Glitches among some readings, the fewest at every place."""
        out: list[int] = []
        for size in (*range(1, MOST + 1), 1):  # what the last ones hid shows without them
            for chosen in itertools.combinations(rows, size):
                near = all(b - a <= SIDE for a, b in itertools.pairwise(chosen))
                if near and not set(chosen) & set(out) and self._explain(chosen, out):
                    out += chosen
        return out

    def _explain(self, chosen: tuple[int, ...], gone: Sequence[int]) -> bool:
        """Whether all is smooth around some readings without them, and no side leads to one of them."""
        first, last = max(chosen[0] - 3 * SIDE, 0), min(chosen[-1] + 3 * SIDE + 1, self.value.size)
        kept = np.array([i for i in range(first, last) if i not in chosen and i not in gone])
        signs = [self._led(i, kept) for i in chosen]
        if 0 in signs:
            return False
        pairs = zip(itertools.pairwise(chosen), itertools.pairwise(signs), strict=True)
        if self.pulses and any(b - a == 1 and up == also == 1 for (a, b), (up, also) in pairs):
            rest = float(np.median(np.abs(self.value[kept[np.abs(kept - chosen[0]) <= 2 * SIDE]])))
            if rest < self.far * self.sigma:
                return False
        return all(self._smooth(int(j), kept) for j in kept if chosen[0] - 3 < j < chosen[-1] + 3)

    def _led(self, i: int, kept: np.ndarray) -> int:
        """0 where the readings of a side lead to this one; else on which side of what both lead to it is, 1 or -1."""
        at = int(np.searchsorted(kept, i))
        before, after = kept[max(at - SIDE, 0) : at][::-1], kept[at : at + SIDE]
        known = [off for rows in (before, after) if (off := _off(self.value, self.sigma, i, rows)) is not None]
        least = LED_TO if len(known) == 2 else self.far
        if known and (min(known) > least or max(known) < -least):
            return 1 if known[0] > 0.0 else -1
        return 0

    def _smooth(self, at: int, kept: np.ndarray) -> bool:
        """Whether a reading is where the cubic through the two kept to either side has it."""
        place = int(np.searchsorted(kept, at))
        near = np.concatenate([kept[max(place - 2, 0) : place], kept[place + 1 : place + 3]])
        if near.size < 4:
            return True
        weights = _cubic(near - at)
        off = abs(float(self.value[at] - weights @ self.value[near]))
        return off <= self.far * self.sigma * float(np.sqrt(1.0 + weights @ weights))


def _off(value: np.ndarray, sigma: float, at: int, rows: np.ndarray) -> float | None:
    """How far a reading is from the parabola through those of a side, in standard errors; None where they are too few.

    Args:
        value, sigma: readings and their noise.
        at: which.
        rows: SIDE others, the nearest first; of these three alone where no parabola holds all, as in a contact.
    """
    if rows.size < SIDE or abs(int(rows[0]) - at) > SIDE:
        return None
    basis = np.vander((rows - at).astype(float), 3, increasing=True)
    inverse = np.linalg.pinv(basis)
    left = value[rows] - basis @ (inverse @ value[rows])
    if float(left @ left) > BENT * sigma**2:
        rows, inverse = rows[:3], np.linalg.inv(basis[:3])
    weights = inverse[0]
    return float(value[at] - weights @ value[rows]) / (sigma * float(np.sqrt(1.0 + weights @ weights)))
