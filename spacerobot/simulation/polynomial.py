"""Polynomials of what moves within a step: value, rate, and where one turns. Compiled."""

from __future__ import annotations

from typing import Any

from spacerobot.support.jit import lean


@lean
def value(p: Any, order: int, theta: float) -> float:
    """p(theta), of degree `order`."""
    total = p[order]
    for k in range(order):
        total = total * theta + p[order - 1 - k]
    return total


@lean
def rate(p: Any, order: int, theta: float) -> float:
    """p'(theta)."""
    total = order * p[order]
    for k in range(order - 1):
        total = total * theta + (order - 1 - k) * p[order - 1 - k]
    return total


@lean
def turn(p: Any, order: int, lo: float, hi: float) -> float:
    """Where the rate changes sign between lo and hi, to 1e-10: a value there is exact to rounding. Illinois method."""
    low, high = rate(p, order, lo), rate(p, order, hi)
    if low * high > 0.0:
        return lo if abs(low) < abs(high) else hi
    x = lo
    for _ in range(60):
        if low == high:
            break
        x = (lo * high - hi * low) / (high - low)
        middle = rate(p, order, x)
        if middle * high <= 0.0:
            lo, low = hi, high
        else:
            low *= 0.5
        hi, high = x, middle
        if abs(hi - lo) < 1e-10 or middle == 0.0:
            break
    return x
