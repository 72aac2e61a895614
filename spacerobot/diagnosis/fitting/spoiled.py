"""What is no reading, and noise that is not what was stated: found before anything is fitted, from the readings alone.

Glitches, markers taken for each other and peaks that a sensor's range has cut off are left out, rounding counts as
noise, and the noise of each channel is what its free approach shows.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.fitting.glitches import SIDE, glitches
from spacerobot.diagnosis.fitting.noise import reweighted
from spacerobot.diagnosis.fitting.swaps import swapped
from spacerobot.diagnosis.machines.rig_trials import touch_time
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.recordings.series import estimate_noise
from spacerobot.support.errors import InputError

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
    """A block whose glitches, exchanged and clipped readings have no weight, and whose rounding counts as noise."""
    weight = block.weight.copy()
    for one, other in itertools.combinations([c for c, name in enumerate(block.channels) if name.endswith(".x")], 2):
        both = np.flatnonzero((weight[one] > 0.0) & (weight[other] > 0.0))
        if both.size:
            sigma = float(np.hypot(1.0 / weight[one][both[0]], 1.0 / weight[other][both[0]]))
            weight[:, both[swapped(block.value[one][both], block.value[other][both], sigma)]] = 0.0
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
