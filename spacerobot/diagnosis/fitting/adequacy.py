"""Is what a fit leaves over noise? Per channel and per trial, against the noise seen before contact.

The test is made where something happens, after the first touch, and compared with the free approach of the same
channels: coloured or understated sensor noise is there too. Left-out physics mostly is not; where the approach is
bent, the same way in every trial, it is, and what is left of the approach without the bend is the noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.approach import approach, lag1
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import GROUP_LIMIT, LEVEL_LIMIT, SIGNIFICANT

MOST_COLOUR = 0.95
"""Autocorrelation from sample to sample that is believed at most: beyond, hardly a sample says anything new."""

STATED = 200
"""Samples before contact that the stated noise level counts for: few trials show too little of it themselves."""


def _coloured(lag1: float) -> float:
    """By what a variance is less sure where noise goes on from sample to sample: sqrt((1 + r^2) / (1 - r^2)).

    Of a first-order process; only what the free approach shows of it counts. (Bartlett 1946.)
    """
    r = min(max(lag1, 0.0), MOST_COLOUR)
    return float(np.sqrt((1.0 + r * r) / (1.0 - r * r)))


@dataclass(frozen=True)
class ChannelLeft:
    """What is left of one channel over all trials."""

    channel: str
    noise: float  # variance before contact, in stated sigmas squared
    level: float  # chi-squared per sample after the first touch
    samples: int
    lag1_before: float
    lag1: float
    colour: float  # excess autocorrelation in standard errors
    worst: float  # largest excess of one trial in standard errors
    worst_trial: str
    early: int = 1_000_000  # samples that the noise before contact rests on
    bent: bool = False  # whether the free approach is no free motion

    @property
    def white(self) -> bool:
        """Whether its approach is free and it passes all three tests."""
        excess = self.level / self.noise - 1.0
        error = _coloured(self.lag1_before) * np.sqrt(2.0 / max(self.samples, 1) + 2.0 / self.early)
        significant = excess > max(LEVEL_LIMIT, SIGNIFICANT * error)
        return not (self.bent or significant or self.colour > SIGNIFICANT or self.worst > GROUP_LIMIT)


@dataclass(frozen=True)
class Left:
    """What a fit leaves over."""

    channels: tuple[ChannelLeft, ...]
    inflation: float  # by which differences of chi-squared are to be divided: noise level and colour

    @property
    def adequate(self) -> bool:
        """Whether every channel looks like noise."""
        return all(c.white for c in self.channels)


def left_over(fit: Fit, trials: Sequence[TrialData], touches: dict[str, float]) -> Left:
    """Tests of a fit's residuals.

    Args:
        fit: with its residuals per trial.
        trials: the data it was fitted to.
        touches: time of the first touch by trial [s].
    """
    before: dict[str, list[np.ndarray]] = {}
    after: dict[str, list[tuple[str, np.ndarray]]] = {}
    for trial in trials:
        residual = fit.trials[trial.id].residual
        row = 0
        for block in trial.blocks:
            for c, channel in enumerate(block.channels):
                r = residual[row : row + block.time.size]
                row += block.time.size
                good = (block.weight[c] > 0.0) & (r != 0.0)
                early = block.time < touches.get(trial.id, np.inf)
                before.setdefault(channel, []).append(r[good & early])
                after.setdefault(channel, []).append((trial.id, r[good & ~early]))
    found = tuple(_channel(name, before[name], after[name]) for name in after)
    weights = np.array([max(c.samples, 1) for c in found], dtype=float)  # none where nothing touches
    colour = np.array([max(c.lag1_before, 0.0) for c in found])
    noise = np.array([max(c.noise, 1.0) for c in found])
    inflation = float(np.average(noise * (1.0 + colour) / (1.0 - np.minimum(colour, 0.9)), weights=weights))
    return Left(found, max(1.0, inflation))


def _channel(name: str, before: Sequence[np.ndarray], after: Sequence[tuple[str, np.ndarray]]) -> ChannelLeft:
    late = [p for _, p in after if p.size]
    count = sum(p.size for p in late)
    level = sum(float(p @ p) for p in late) / max(count, 1)
    early = approach(before, level)
    known = early.count + STATED
    noise = (early.level * early.count + STATED) / known
    lag_before, n_before = lag1(early.parts) if early.count >= 30 else (0.0, 1_000_000)
    lag, n_after = lag1(late)
    unsure = np.sqrt(1.0 / max(n_before, 1) + 1.0 / max(n_after, 1))
    worst, worst_trial = -np.inf, ""
    for trial, p in after:
        if p.size >= 20:
            spread = _coloured(lag_before) ** 2 * (1.0 / p.size + 1.0 / known) / 4.5
            score = (np.cbrt(float(p @ p) / p.size / noise) - 1.0 + spread) / np.sqrt(spread)  # Wilson and Hilferty
            if score > worst:
                worst, worst_trial = score, trial
    return ChannelLeft(
        name,
        noise,
        level,
        count,
        lag_before,
        lag,
        (lag - lag_before) / unsure,
        float(worst),
        worst_trial,
        known,
        early.bent,
    )
