"""Gains in chi-squared that chance brings."""

from __future__ import annotations

import math

from scipy.special import chdtri

CHANCE = 0.05
"""Probability with which parameters that mean nothing gain as much as counts, where the noise is stated."""


def by_chance(gain: float, parameters: int, looks: int = 1) -> bool:
    """Whether so many further parameters that mean nothing may well lower chi-squared by so much (Wilks).

    Args:
        gain: what chi-squared comes down by.
        parameters: how many more there are.
        looks: effects and places that were tried and of which this is the best (Sidak).
    """
    return gain <= float(chdtri(parameters, -math.expm1(math.log1p(-CHANCE) / max(looks, 1))))
