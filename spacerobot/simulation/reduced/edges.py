"""Kinks of laws that are straight between them, such as the ends of a gap: where a step crosses them. Compiled.

Steps of straight modes are long, and a gap may be entered and left within one, so that looking at a few moments does
not do. The displacement is a polynomial, so the step is parted where that turns and where it passes zero; a law's edge
changes sign at most once in each part (`effects.kernel.Kernel` asks for that).
"""

from __future__ import annotations

from typing import Any

from spacerobot.effects.kernel import PARAMETERS
from spacerobot.simulation.polynomial import rate, turn, value
from spacerobot.simulation.reduced.affine import swings
from spacerobot.simulation.reduced.arrays import EDGE, FORCES, PARAMETER, SENSE, SLOPE, W_ROWS, YAW, N
from spacerobot.simulation.reduced.crossings import AT
from spacerobot.simulation.reduced.forces import call_law
from spacerobot.support.jit import lean

HALVINGS = 52


@lean
def first_edge(
    x: Any, c: Any, laws: Any, modes: Any, w: Any, y: Any, h: float, q: Any, order: int, p: Any, mode: int, theta: float
) -> Any:
    """First edge of a straight law to be crossed within a step before another guard falls: (mode, theta).

    An edge of what turns with the target is left to `events.find_event`.

    Args:
        y, h, q, order: of the step, see `stepper.interpolate`.
        p: scratch, shape (at least order + 1,).
        mode, theta: of the guard that falls first, of `crossings.first_fall` or `events.find_event`; returned where
            no edge comes before.
    """
    n = c[N]
    for j in range(c[FORCES]):
        edge = c[c[EDGE] + j]
        if edge < 0 or c[c[SLOPE] + j] < 0 or (c[YAW] >= 0 and swings(c, c[c[SENSE] + j])):
            continue
        row = c[W_ROWS] + c[c[SENSE] + j] * n
        p[0] = 0.0
        for i in range(n):
            p[0] += w[row + i] * y[i]
        for d in range(order):
            total = 0.0
            for i in range(n):
                total += w[row + i] * q[i, d]
            p[d + 1] = h * total
        found = _crossed(laws[edge], x, c[PARAMETER] + PARAMETERS * j, float(modes[1 + j]), p, order, theta)
        if found < theta:
            mode, theta = 1 + j, found
    return mode, theta


@lean
def _crossed(edge: int, x: Any, first: int, side: float, p: Any, order: int, end: float) -> float:
    """First theta before `end` beyond which the edge has another sign than `side`; 2 if there is none."""
    lo, was = 0.0, rate(p, order, 0.0)
    for k in range(1, len(AT)):
        hi = min(AT[k], end)
        if hi <= lo:
            break
        now = rate(p, order, hi)
        back = turn(p, order, lo, hi) if was * now < 0.0 else hi
        found = _one_way(edge, x, first, side, p, order, lo, back)
        if found > 1.0 and back < hi:
            found = _one_way(edge, x, first, side, p, order, back, hi)
        if found <= 1.0:
            return found
        lo, was = hi, now
    return 2.0


@lean
def _one_way(edge: int, x: Any, first: int, side: float, p: Any, order: int, lo: float, hi: float) -> float:
    """The same between two moments within which the displacement does not turn."""
    start = value(p, order, lo)
    if start * value(p, order, hi) < 0.0:
        inner, outer = lo, hi
        for _ in range(HALVINGS):
            mid = 0.5 * (inner + outer)
            if value(p, order, mid) * start > 0.0:
                inner = mid
            else:
                outer = mid
        if side * call_law(edge, 0.0, 0.0, 0.0, x, first) < 0.0:
            return _fallen(edge, x, first, side, p, order, lo, outer)
        lo = outer
    if side * call_law(edge, value(p, order, hi), 0.0, 0.0, x, first) < 0.0:
        return _fallen(edge, x, first, side, p, order, lo, hi)
    return 2.0


@lean
def _fallen(edge: int, x: Any, first: int, side: float, p: Any, order: int, lo: float, hi: float) -> float:
    for _ in range(HALVINGS):
        mid = 0.5 * (lo + hi)
        if side * call_law(edge, value(p, order, mid), 0.0, 0.0, x, first) < 0.0:
            hi = mid
        else:
            lo = mid
    return hi
