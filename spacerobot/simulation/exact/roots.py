"""First fall of a polynomial below zero, and its maximum, inside a step. Compiled."""

from __future__ import annotations

from typing import Any

from spacerobot.simulation.exact.propagator import slope, value
from spacerobot.support.jit import lean

PIECES = 6
"""A step is searched in so many pieces; each holds one extremum at most, being a small part of the fastest period."""


@lean
def extremum(p: Any, lo: float, hi: float) -> float:
    """Where the slope changes sign between lo and hi, to 1e-10: a value there is exact to rounding. Illinois method."""
    low, high = slope(p, lo), slope(p, hi)
    if low * high > 0.0:
        return lo if abs(low) < abs(high) else hi
    x = lo
    for _ in range(60):
        if low == high:
            break
        x = (lo * high - hi * low) / (high - low)
        middle = slope(p, x)
        if middle * high <= 0.0:
            lo, low = hi, high
        else:
            low *= 0.5
        hi, high = x, middle
        if abs(hi - lo) < 1e-10 or middle == 0.0:
            break
    return x


@lean
def _between(p: Any, lo: float, hi: float) -> float:
    """Root between lo (not negative) and hi (negative); Newton kept inside the bracket."""
    x = hi
    for _ in range(80):
        f = value(p, x)
        if f < 0.0:
            hi = x
        else:
            lo = x
        d = slope(p, x)
        new = x - f / d if d < 0.0 else lo - 1.0
        if not (lo < new < hi):
            new = 0.5 * (lo + hi)
        if abs(new - x) <= 1e-16 or hi - lo <= 1e-16:
            return new
        x = new
    return x


@lean
def first_fall(p: Any, end: float) -> float:
    """First theta in [0, end] at which p, having been positive, falls below zero; 2 where it does not.

    At theta = 0 the sign of a rounded zero does not count, the slope does.
    """
    lo = 0.0
    positive = p[0] > 0.0
    for j in range(1, PIECES + 1):
        hi = end * j / PIECES
        f = value(p, hi)
        before, after = slope(p, lo), slope(p, hi)
        if not positive:  # just switched: rises out of zero, or falls at once
            if before > 0.0 and f > 0.0:
                positive = True
            elif before > 0.0:
                top = extremum(p, lo, hi)
                if value(p, top) > 0.0:
                    return _between(p, top, hi)
                return lo
            elif f < 0.0:
                return lo
        elif f < 0.0:
            return _between(p, lo, hi)
        elif before < 0.0 and after > 0.0:
            bottom = extremum(p, lo, hi)
            if value(p, bottom) < 0.0:
                return _between(p, lo, bottom)
        lo = hi
    return 2.0
