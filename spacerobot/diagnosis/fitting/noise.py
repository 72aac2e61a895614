"""How much of a residual counts as independent: unknown noise, and models that are never quite right.

Where a laboratory states its sensors' noise, chi-squared has a meaning of its own. A public recording rarely does,
and even the best model leaves a residual that is slow, not white: 25,000 samples of it are perhaps 200 independent
ones. Weighted by what the best model leaves, and by how long that stays alike, differences of chi-squared mean the
same for both.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.terms.data import TrialData

NEXT_TO_NOTHING = 1e-6
"""Share of what all channels leave over that is as good as nothing: one that is told exactly has no logarithm."""


def correlation_time(residual: np.ndarray) -> float:
    """Integrated autocorrelation of a series in samples, at least 1: n/tau of n samples are independent.

    1 + 2 sum rho_k, summed up to the first lag at which the correlation has fallen to zero (the initial positive
    sequence of Geyer 1992, Eq. 3.3, in its plain form).

    Args:
        residual: shape (T,), evenly spaced; its mean is not taken off, a constant residual is all one sample.
    """
    n = residual.size
    power = float(np.mean(residual**2)) if n else 0.0
    if n < 3 or power == 0.0:
        return 1.0
    size = 1 << (2 * n - 1).bit_length()
    spectrum = np.fft.rfft(residual, size)
    correlation = np.fft.irfft(np.abs(spectrum) ** 2, size)[:n] / (power * n)
    below = np.flatnonzero(correlation <= 0.0)
    end = int(below[0]) if below.size else n
    return float(min(max(1.0 + 2.0 * correlation[1:end].sum(), 1.0), n))


def split(residual: np.ndarray, trial: TrialData) -> dict[str, np.ndarray]:
    """A trial's residual, shape (S,), by channel, shape (T,) each."""
    out, at = {}, 0
    for block in trial.blocks:
        for channel in block.channels:
            out[channel] = residual[at : at + block.time.size]
            at += block.time.size
    return out


def counted_by_channel(residuals: Mapping[str, np.ndarray], trials: Sequence[TrialData]) -> dict[str, list[np.ndarray]]:
    """Of each channel what is left of the readings that count, trial by trial; others have exactly nothing left."""
    out: dict[str, list[np.ndarray]] = {}
    for trial in trials:
        for channel, part in split(residuals[trial.id], trial).items():
            out.setdefault(channel, []).append(part[part != 0.0])
    return out


def common_level(squares: np.ndarray, counts: np.ndarray, least: float | None = None) -> float:
    """Mean square of several channels as if each had left as much a reading: their geometric mean.

    How large a channel's noise is nobody knows: so likelihoods of their squares are multiplied, where the mean over all
    readings would hear the channel alone that is furthest from its noise.

    Args:
        squares: sums, shape (C,).
        counts: readings of each, shape (C,).
        least: mean square that is as good as nothing, added to each; that share of the plain mean if None.
    """
    every = max(float(counts.sum()), 1.0)
    if least is None:
        least = NEXT_TO_NOTHING * float(squares.sum()) / every
    each = squares / np.maximum(counts, 1.0) + least
    return float(np.exp(counts @ np.log(np.maximum(each, 1e-300)) / every))


def floor_of(residuals: Mapping[str, np.ndarray], trials: Sequence[TrialData]) -> dict[str, float]:
    """By channel, the factor by which its weights must fall for chi-squared to count independent samples.

    Args:
        residuals: weighted residuals of the best model, by trial, shape (S,).
        trials: which trials.

    Returns:
        channel -> sqrt(mean square times correlation time), in units of the present weights.
    """
    squares: dict[str, float] = {}
    counts: dict[str, int] = {}
    times: dict[str, list[tuple[float, int]]] = {}
    for trial in trials:
        for channel, part in split(residuals[trial.id], trial).items():
            squares[channel] = squares.get(channel, 0.0) + float(part @ part)
            counts[channel] = counts.get(channel, 0) + part.size
            times.setdefault(channel, []).append((correlation_time(part), part.size))
    out = {}
    for channel, square in squares.items():
        mean = sum(t * n for t, n in times[channel]) / counts[channel]
        out[channel] = float(np.sqrt(square / counts[channel] * mean))
    return out


def rms_of(residuals: Mapping[str, np.ndarray], trials: Sequence[TrialData]) -> dict[str, float]:
    """Root mean square of the weighted residuals by channel, in units of the present weights."""
    squares: dict[str, float] = {}
    counts: dict[str, int] = {}
    for trial in trials:
        for channel, part in split(residuals[trial.id], trial).items():
            squares[channel] = squares.get(channel, 0.0) + float(part @ part)
            counts[channel] = counts.get(channel, 0) + part.size
    return {c: float(np.sqrt(s / counts[c])) for c, s in squares.items()}


def squares_of(
    residuals: Mapping[str, np.ndarray],
    trials: Sequence[TrialData],
    counted: Mapping[str, np.ndarray] | None = None,
) -> dict[str, tuple[float, int]]:
    """By channel: the sum of squares of what counts of a residual, in the channel's unit squared, and its readings.

    Args:
        residuals: weighted, by trial, shape (S,); a trial that has none is passed over.
        trials: which trials.
        counted: which readings count, by trial, shape (S,); those that have a weight if None.
    """
    out: dict[str, tuple[float, int]] = {}
    for trial in trials:
        if trial.id not in residuals:
            continue
        found = split(residuals[trial.id], trial)
        counts = None if counted is None else split(counted[trial.id], trial)
        for block in trial.blocks:
            for channel, weight in zip(block.channels, block.weight, strict=True):
                good = weight > 0.0 if counts is None else counts[channel].astype(bool)
                value = found[channel][good] / weight[good]
                square, readings = out.get(channel, (0.0, 0))
                out[channel] = (square + float(value @ value), readings + value.size)
    return out


def levels_of(
    residuals: Mapping[str, np.ndarray],
    trials: Sequence[TrialData],
    counted: Mapping[str, np.ndarray] | None = None,
) -> dict[str, float]:
    """Root mean square of the same by channel, in the channel's unit."""
    return {c: float(np.sqrt(s / max(n, 1))) for c, (s, n) in squares_of(residuals, trials, counted).items()}


def reweighted(trials: Sequence[TrialData], factor: Mapping[str, float]) -> tuple[TrialData, ...]:
    """The trials with each channel's weights divided by its factor; a factor of zero changes nothing."""
    out = []
    for trial in trials:
        blocks = []
        for block in trial.blocks:
            by = np.array([factor.get(c, 1.0) or 1.0 for c in block.channels])
            blocks.append(replace(block, weight=block.weight / by[:, None]))
        out.append(replace(trial, blocks=tuple(blocks)))
    return tuple(out)
