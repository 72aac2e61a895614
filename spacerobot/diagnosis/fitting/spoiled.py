"""Readings that are no readings, found before anything is fitted: glitches, clipped peaks, and the noise as it is.

All of this is asked of the readings alone. A glitch is one reading that neither those before it, nor those after it,
nor those on both sides lead to; what bends a track, a touch or a peak, agrees with one of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import norm

from spacerobot.diagnosis.fitting.noise import reweighted
from spacerobot.diagnosis.machines.wrist_rig import touch_time
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.recordings.series import estimate_noise
from spacerobot.support.errors import InputError

CHANCE = 1e-6
"""Probability that Gaussian noise of so many readings has one so far out."""

BETWEEN = np.array([-1.0, 4.0, 4.0, -1.0]) / 6.0
"""Weights of two readings to either side in the cubic through them, at the reading between."""

SIDE = 5
"""Readings on one side that say where the next should be."""

LED_TO = 4.0
"""Standard errors within which a side leads to a reading: beyond, one step in 15,000 would be taken for a glitch."""

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
        weight[c] *= sigma / np.hypot(sigma, step / np.sqrt(12.0))
        noise = max(sigma, estimate_noise(value), step)
        out = glitches(value, noise, longest=1 if channel.endswith(".force") else 2)
        if channel.endswith(".force"):
            out |= clipped(value, noise)
        weight[c][good[out]] = 0.0
    return replace(block, weight=weight)


def glitches(value: np.ndarray, sigma: float, longest: int = 1) -> np.ndarray:
    """Readings that nothing around them leads to, shape (T,) bool.

    A reading is suspected that is not where the cubic through its neighbours has it, which then are too. It is a
    glitch where neither the readings before it nor those after it lead to it, the suspected apart, or only those of
    them that stand out: a bend or a step is led to by one side.

    Args:
        value: shape (T,), in order of time, about evenly spaced.
        sigma: standard deviation of their noise.
        longest: readings in a row that may be one glitch; a pulse has more.
    """
    out = np.zeros(value.size, dtype=bool)
    if value.size < 4 * SIDE:
        return out
    far = float(norm.isf(CHANCE / (2.0 * value.size)))
    between = np.zeros(value.size)
    outer, inner = value[:-4] + value[4:], value[1:-3] + value[3:-1]
    between[2:-2] = np.abs(value[2:-2] - (BETWEEN[0] * outer + BETWEEN[1] * inner))
    suspected = between > far * sigma * np.sqrt(1.0 + float(BETWEEN @ BETWEEN))
    outstanding = suspected & (between >= np.maximum(np.roll(between, 1), np.roll(between, -1)))
    for end in (suspected, outstanding):
        end[[0, 1, -2, -1]] = True  # nothing is on both sides of these
    for apart in (outstanding, suspected):
        trusted = np.flatnonzero(~apart)
        for i in np.flatnonzero(apart).tolist():
            at = int(np.searchsorted(trusted, i))
            sides = (trusted[max(at - SIDE, 0) : at], trusted[at : at + SIDE])
            known = [off for rows in sides if (off := _off(value, sigma, i, rows)) is not None]
            least = LED_TO if len(known) == 2 else far
            out[i] |= bool(known) and (min(known) > least or max(known) < -least)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], out.astype(int), [0]])))
    for first, last in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if last - first > longest:
            out[first:last] = False
    return out


def _off(value: np.ndarray, sigma: float, at: int, rows: np.ndarray) -> float | None:
    """How far a reading is from the parabola through some others, in standard errors; None where that says nothing."""
    if rows.size < SIDE or np.abs(rows - at).min() > SIDE:
        return None
    basis = np.vander((rows - at).astype(float), 3, increasing=True)
    weights = np.linalg.pinv(basis)[0]
    return float(value[at] - weights @ value[rows]) / (sigma * float(np.sqrt(1.0 + weights @ weights)))


def clipped(value: np.ndarray, sigma: float) -> np.ndarray:
    """Readings at the end of a sensor's range, shape (T,) bool: several in a row that are its very largest."""
    top = value == value.max()
    if value.max() < 10.0 * sigma or top.sum() < PLATEAU:
        return np.zeros(value.size, dtype=bool)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], top.astype(int), [0]])))
    longest = int((edges[1::2] - edges[::2]).max())
    return top if longest >= PLATEAU else np.zeros(value.size, dtype=bool)


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
                if quantum(block.value[c][good], 1.0 / float(block.weight[c][good][0])) > 0.0:
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
