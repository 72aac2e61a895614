"""First fall of a polynomial below zero inside a step. Compiled."""

from __future__ import annotations

from typing import Any

from spacerobot.simulation.exact.propagator import DEGREE
from spacerobot.simulation.polynomial import rate, turn, value
from spacerobot.support.jit import lean

PIECES = 6
"""A step is searched in so many pieces; each holds one extremum at most, being a small part of the fastest period."""


@lean
def _between(p: Any, lo: float, hi: float) -> float:
    """Root between lo (not negative) and hi (negative); Newton kept inside the bracket."""
    x = hi
    for _ in range(80):
        f = value(p, DEGREE, x)
        if f < 0.0:
            hi = x
        else:
            lo = x
        d = rate(p, DEGREE, x)
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
        f = value(p, DEGREE, hi)
        before, after = rate(p, DEGREE, lo), rate(p, DEGREE, hi)
        if not positive:  # just switched: rises out of zero, or falls at once
            if before > 0.0 and f > 0.0:
                positive = True
            elif before > 0.0:
                top = turn(p, DEGREE, lo, hi)
                if value(p, DEGREE, top) > 0.0:
                    return _between(p, top, hi)
                return lo
            elif f < 0.0:
                return lo
        elif f < 0.0:
            return _between(p, lo, hi)
        elif before < 0.0 and after > 0.0:
            bottom = turn(p, DEGREE, lo, hi)
            if value(p, DEGREE, bottom) < 0.0:
                return _between(p, lo, bottom)
        lo = hi
    return 2.0
