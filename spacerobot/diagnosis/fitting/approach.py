"""The free approach, as a fit leaves it: noise, or a motion that is not free.

Before the first touch a target moves evenly, and the start of every trial is fitted. What bends the approach the same
way in trial after trial is therefore physics, or a start that physics further on has bent; noise that wanders bends it
one way here and another there, and wanders on after the touch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from spacerobot.diagnosis.terms.decision import LEVEL_LIMIT, SIGNIFICANT

ORDERS = 3
"""Offset, slope and curvature of what is left of an approach."""

CHANCE = 1e-4
"""Probability below which a bend that is alike in all trials is none of chance's."""

SHORTEST = 4 * ORDERS
"""Samples of an approach below which a bend cannot be told from noise."""

FEWEST = 4
"""Trials below which nothing can be said of what they have in common."""


@dataclass(frozen=True)
class Approach:
    """What is left of one channel's approaches.

    Attributes:
        parts: residuals of each trial [stated sigmas].
        level: their variance [stated sigmas squared].
        count: samples.
        bent: whether they are no noise.
    """

    parts: tuple[np.ndarray, ...]
    level: float
    count: int
    bent: bool


def approach(parts: Sequence[np.ndarray], later: float) -> Approach:
    """Look for a bend: one that the trials have in common, or that what is left after the touch knows nothing of.

    Noise that wanders bends the approach too, but goes on wandering. Where there is a bend, the noise is what is left
    without it.

    Args:
        parts: residuals before the first touch, one array a trial, in order of time [stated sigmas].
        later: variance of what is left after it [stated sigmas squared].
    """
    count = sum(p.size for p in parts)
    plain = Approach(tuple(parts), sum(float(p @ p) for p in parts) / max(count, 1), count, False)
    long = [p for p in parts if p.size >= SHORTEST]
    if len(long) < FEWEST:
        return plain
    coefficients, straight = [], []
    for p in long:
        basis, _ = np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, p.size), ORDERS, increasing=True))
        basis = basis * np.sign(basis[-1])  # the same sense in every trial
        coefficients.append(basis.T @ p)
        straight.append(p - basis @ coefficients[-1])
    found = np.array(coefficients)
    left = sum(p.size for p in straight) - found.size
    noise = sum(float(p @ p) for p in straight) / left
    share = (float(np.square(found).sum()) - found.size * noise) / (noise * count)
    if share < max(LEVEL_LIMIT, SIGNIFICANT * np.sqrt(2.0 * found.size) / count):
        return plain
    error = np.maximum(found.std(axis=0, ddof=1), 1e-300) / np.sqrt(len(long))
    alike = 2.0 * student.sf(np.abs(found.mean(axis=0)) / error, len(long) - 1)
    if alike.min() < CHANCE or later < 0.5 * (noise + plain.level):
        return Approach(tuple(straight), noise, left, True)
    return plain


def lag1(parts: Sequence[np.ndarray]) -> tuple[float, int]:
    """Autocorrelation from one sample to the next, and the samples it rests on."""
    top = sum(float(p[1:] @ p[:-1]) for p in parts if p.size > 1)
    bottom = sum(float(p @ p) for p in parts if p.size > 1)
    return (top / bottom if bottom > 0.0 else 0.0), sum(p.size for p in parts)
