"""Numbers drawn as a lab's might be."""

from __future__ import annotations

import numpy as np


def by_factors(rng: np.random.Generator, low: float, high: float) -> float:
    """A number between two, drawn evenly in the logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def to_digits(value: float, digits: int) -> float:
    """A value as it is stated, to so many significant digits."""
    return float(f"{value:.{digits}g}")
