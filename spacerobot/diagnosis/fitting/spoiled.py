"""Readings that are no readings, found before anything is fitted: glitches, clipped peaks, and the noise as it is.

All of this is asked of the readings alone. A glitch is one reading that neither those before it, nor those after it,
nor those on both sides lead to; what bends a track, a touch or a peak, agrees with one of them.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm

from spacerobot.diagnosis.fitting.noise import reweighted
from spacerobot.diagnosis.machines.wrist_rig import touch_time
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.recordings.series import estimate_noise
from spacerobot.support.errors import InputError

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

PLATEAU = 3
"""Equal readings in a row, at the largest value of all, that a sensor's end makes and noise does not."""

PRIOR = np.log(2.0)
"""One standard deviation of the logarithm of what a study says of a sensor's noise: a factor of two."""

ABSURD = 5.0
"""Of these, how many off is no misjudged noise but a wrong unit: a factor of 32."""

TOLD = 0.1
"""Relative difference of the noise from what is stated that is taken over and told: chi-squared is a fifth off then."""

FEWEST = 20
"""Readings of the free approach that say something of the noise."""

CLEAR_OF_TOUCH = 0.02
"""Seconds before the touch that the free approach ends."""


def cleaned(trials: Sequence[TrialData]) -> tuple[TrialData, ...]:
    """The trials of a wrist rig without what is no reading, weighed by the noise that they have.

    Raises:
        InputError: what is stated of a channel's noise is no noise of it.
    """
    left = [replace(t, blocks=tuple(without_spoiled(b) for b in t.blocks)) for t in trials]
    return reweighted(left, noise_found(left))


def without_spoiled(block: Block) -> Block:
    """A block whose glitches and clipped readings have no weight, and whose rounding counts as noise."""
    weight = block.weight.copy()
    for c, channel in enumerate(block.channels):
        good = np.flatnonzero(weight[c] > 0.0)
        value = block.value[c][good]
        if value.size < 4 * SIDE:
            continue
        sigma = 1.0 / float(weight[c][good[0]])
        step = quantum(value, sigma)
        if step > 0.0:
            weight[c] *= sigma / np.hypot(sigma, step / np.sqrt(12.0))
            weight[c][good] /= np.sqrt(repeats(value))  # a reading that stands still is one
        noise = max(sigma, estimate_noise(value), step)
        out = glitches(value, noise, pulses=channel.endswith(".force"))
        if channel.endswith(".force"):
            out |= clipped(value, noise)
        weight[c][good[out]] = 0.0
    return replace(block, weight=weight)


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
        for size in range(1, MOST + 1):
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


def clipped(value: np.ndarray, sigma: float) -> np.ndarray:
    """Readings at the end of a sensor's range, shape (T,) bool: several in a row that are its very largest."""
    top = value == value.max()
    if value.max() < 10.0 * sigma or top.sum() < PLATEAU:
        return np.zeros(value.size, dtype=bool)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], top.astype(int), [0]])))
    longest = int((edges[1::2] - edges[::2]).max())
    return top if longest >= PLATEAU else np.zeros(value.size, dtype=bool)


def repeats(value: np.ndarray) -> np.ndarray:
    """How many equal readings in a row each one is among, shape (T,)."""
    edges = np.concatenate([[0], 1 + np.flatnonzero(np.diff(value)), [value.size]])
    return np.repeat(np.diff(edges), np.diff(edges)).astype(float)


def quantum(value: np.ndarray, sigma: float) -> float:
    """The step that readings are rounded to, where it is coarser than their noise; 0 elsewhere."""
    levels = np.unique(value)
    if levels.size < 2:
        return 0.0
    steps = np.diff(levels)
    finest = steps[steps > 1e-3 * sigma]  # less is the arithmetic of an offset
    if not finest.size or finest.min() <= sigma:
        return 0.0
    step = float(np.median(finest[finest <= 1.5 * finest.min()]))
    off = np.abs((levels - levels[0]) / step - np.round((levels - levels[0]) / step))
    return step if off.max() < 0.1 else 0.0


def noise_found(trials: Sequence[TrialData]) -> dict[str, float]:
    """By channel, its noise in the free approach over what the weights say, where that is more than a trifle off.

    What is stated counts as one reading known to a factor of two would.

    Args:
        trials: the data.

    Raises:
        InputError: what is stated of a channel's noise is no noise of it.
    """
    logs: dict[str, list[np.ndarray]] = {}
    rounded = set()
    for trial in trials:
        touch = touch_time(trial)
        for block in trial.blocks:
            for c, channel in enumerate(block.channels):
                good = (block.time < touch - CLEAR_OF_TOUCH) & (block.weight[c] > 0.0)
                if good.sum() < FEWEST:
                    continue
                if quantum(block.value[c][good], 1.0 / float(block.weight[c][good].max())) > 0.0:
                    rounded.add(channel)
                weighted = block.value[c][good] * block.weight[c][good]
                span = block.time[good] - block.time[good].mean()
                basis, _ = np.linalg.qr(np.vander(span / np.abs(span).max(), 3))
                logs.setdefault(channel, []).append(weighted - basis @ (basis.T @ weighted))
    out = {}
    for channel, parts in logs.items():
        left = np.concatenate(parts)
        count = left.size - 3 * len(parts)
        scatter = float(np.median(np.abs(left))) / 0.6744897501960817 * np.sqrt(left.size / max(count, 1))
        if channel in rounded or not scatter > 0.0:
            continue  # rounding has been counted, and a rest that is rounded shows no noise at all
        found = np.log(scatter)
        if abs(found) > ABSURD * PRIOR:
            raise InputError(
                f"the noise of {channel} is not what its sigma says",
                given=f"readings scatter by {scatter:.3g} times its sigma before the touch",
                valid="sigma in the channel's own unit, within a factor of 30",
                where=f"[streams.{next(b.stream for t in trials for b in t.blocks if channel in b.channels)}]",
            )
        error = 1.0 / np.sqrt(2.0 * count * 0.37)  # a median's efficiency
        found *= PRIOR**2 / (PRIOR**2 + error**2)
        if abs(found) > max(np.log1p(TOLD), 3.0 * error):
            out[channel] = float(np.exp(found))
    return out
