"""One root of a scalar function inside a bracket, to the last digit."""

from __future__ import annotations

import math
from collections.abc import Callable


def bracketed_root(f: Callable[[float], float], low: float, high: float, *, iterations: int = 200) -> float:
    """The root of `f` in [low, high], where `f` changes sign.

    Regula falsi with the Illinois weight, and a bisection wherever a step gained less than half: it needs no
    derivative, never leaves the bracket, and stops when the bracket cannot shrink any further in floating
    point.

    Args:
        f: the function.
        low: lower end.
        high: upper end; f(low) and f(high) must differ in sign (either may be zero).
        iterations: the most steps.

    Returns:
        The abscissa of the root.

    Raises:
        ValueError: the ends do not bracket a sign change.
    """
    f_low, f_high = f(low), f(high)
    if f_low == 0:
        return low
    if f_high == 0:
        return high
    if not f_low * f_high < 0:
        raise ValueError(f"no sign change in the bracket: f({low!r}) = {f_low!r}, f({high!r}) = {f_high!r}")
    side = 0
    for step in range(iterations):
        x = (low * f_high - high * f_low) / (f_high - f_low)
        if step % 3 == 2 or not min(low, high) < x < max(low, high):
            x, side = 0.5 * (low + high), 0
        if x in (low, high):
            break
        value = f(x)
        if value == 0:
            return x
        if (value < 0) == (f_low < 0):
            low, f_low = x, value
            if side == -1:
                f_high *= 0.5
            side = -1
        else:
            high, f_high = x, value
            if side == 1:
                f_low *= 0.5
            side = 1
        if abs(high - low) <= 2.0 * math.ulp(max(abs(low), abs(high))):
            break
    return 0.5 * (low + high)
