"""Markers taken for each other: for some readings two tracks stand where the other was, and nothing else moves."""

from __future__ import annotations

import numpy as np

APART = 20.0
"""Standard deviations that the two must be apart for an exchange to show beside their noise."""

ALIKE = 0.2
"""By what share of their distance it may have changed from one reading to the next, but for its sign."""


def swapped(one: np.ndarray, other: np.ndarray, sigma: float) -> np.ndarray:
    """Readings in which two tracks are exchanged, shape (T,) bool.

    The distance between them then turns its sign from one reading to the next, and back again or to the end, while its
    size and the middle between them go on as before: bodies would have to pass through each other at once, twice.

    Args:
        one, other: positions at the same times, shape (T,).
        sigma: standard deviation of their difference's noise.
    """
    apart, middle = one - other, one + other
    far = np.minimum(np.abs(apart[1:]), np.abs(apart[:-1])) > APART * sigma
    turned = far & (np.abs(apart[1:] + apart[:-1]) < ALIKE * np.abs(apart[1:] - apart[:-1]))
    still = np.abs(np.diff(middle)) < ALIKE * np.abs(np.diff(apart))
    at = 1 + np.flatnonzero(turned & still)
    out = np.zeros(one.size, dtype=bool)
    if at.size:
        edges = np.concatenate([[0], at, [one.size]])
        stretch = np.repeat(np.arange(edges.size - 1), np.diff(edges)) % 2 == 1
        out = stretch if stretch.sum() <= one.size / 2 else ~stretch
    return out
