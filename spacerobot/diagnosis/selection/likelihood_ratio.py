"""Gains in chi-squared that chance brings."""

from __future__ import annotations

from scipy.special import chdtri

CHANCE = 0.05
"""Probability with which parameters that mean nothing gain as much as counts, where the noise is stated."""


def by_chance(gain: float, parameters: int) -> bool:
    """Whether so many further parameters that mean nothing may well lower chi-squared by so much (Wilks)."""
    return gain <= float(chdtri(parameters, CHANCE))
