"""Guards that are linear in the state: polynomials within a step, whose first root is found. Compiled."""

from __future__ import annotations

from typing import Any

from spacerobot.effects.kernel import PARAMETERS
from spacerobot.simulation.polynomial import rate, turn, value
from spacerobot.simulation.reduced.arrays import (
    CONTACT_FORCE,
    EDGE,
    FORCES,
    FRICTION_NORMAL,
    FRICTION_PORT,
    FRICTIONS,
    GEOMETRY,
    LAW,
    NATIVE_CONTACT,
    PARAMETER,
    PRESS,
    REST,
    STATE_LINEAR,
    STATE_PORT,
    STATES,
    W_ROWS,
    YAW,
    D,
    N,
)
from spacerobot.simulation.reduced.forces import APART, PRESSED, STICK, TINY, level
from spacerobot.support.jit import lean

AT = (0.0, 0.01, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Where in a step each polynomial and its slope are looked at."""

ROUNDING = 1e-12
"""Share of what a polynomial does within the step that is taken for zero."""


@lean
def linear_guards(x: Any, c: Any, laws: Any, modes: Any, w: Any, even: bool, held: Any, g: Any, owner: Any) -> int:
    """Fills g, shape (., 2n + S + 1 + U), with rows over (q, v, z, 1, u) that are positive while modes hold; how many.

    Args:
        even: whether the modes are straight, see `affine.straight`.
        held: forces of what sticks in straight modes, of `affine.system`.
        owner: filled with the index of the mode that each row guards.

    Returns:
        number of rows; -1 where a guard is not linear.
    """
    n, count = c[N], 0
    last = 2 * n + c[STATES]
    for k in range(g.shape[0]):
        for i in range(2 * n, g.shape[1]):
            g[k, i] = 0.0
    if c[YAW] >= 0:
        return -1
    for j in range(c[FORCES]):
        if c[c[EDGE] + j] >= 0 and not even:  # of straight laws `edges` takes care
            return -1
    if c[PRESS] >= 0:
        row = c[W_ROWS] + c[PRESS] * n
        force = c[CONTACT_FORCE]
        first = c[PARAMETER] + PARAMETERS * force
        plain = c[c[LAW] + force] == NATIVE_CONTACT and x[first + 2] == 1.0 and x[first + 3] == 0.0
        pulling = modes[0] == PRESSED and x[c[GEOMETRY] + 3] > 0.5
        if modes[0] != PRESSED or pulling:
            sign = -1.0 if modes[0] == APART else 1.0
            for i in range(n):
                g[count, i], g[count, n + i] = sign * w[row + i], 0.0
            g[count, last] = 0.0
            owner[count] = 0
            count += 1
        if modes[0] != APART and not pulling:
            if not plain:
                return -1
            sign = 1.0 if modes[0] == PRESSED else -1.0
            for i in range(n):
                g[count, i] = sign * x[first] * w[row + i]
                g[count, n + i] = sign * x[first + 1] * w[row + i]
            g[count, last] = x[c[GEOMETRY] + 2] if modes[0] == PRESSED else 0.0
            owner[count] = 0
            count += 1
    base = 1 + c[FORCES]
    for r in range(c[FRICTIONS]):
        m = modes[base + r]
        if m != STICK:
            if _rests(c, modes, c[c[FRICTION_PORT] + r]):
                continue
            row = c[W_ROWS] + c[c[FRICTION_PORT] + r] * n
            for i in range(n):
                g[count, i], g[count, n + i] = 0.0, m * w[row + i]
            g[count, last] = 0.0
            owner[count] = base + r
            count += 1
            continue
        if not even or c[c[FRICTION_NORMAL] + r] == 1:
            return -1
        for side in (-1.0, 1.0):
            for i in range(g.shape[1]):
                g[count, i] = side * held[r, i]
            limit = level(x, c, laws, r, side * TINY, 0.0, w[c[D] + c[c[FRICTION_PORT] + r]])  # it is at rest
            g[count, last] += limit * (1.0 + 1e-12) + 1e-300
            owner[count] = base + r
            count += 1
    base += c[FRICTIONS]
    for s in range(c[STATES]):
        if c[c[STATE_LINEAR] + s] == 0:
            row = c[W_ROWS] + c[c[STATE_PORT] + s] * n
            for i in range(n):
                g[count, i], g[count, n + i] = 0.0, modes[base + s] * w[row + i]
            g[count, last] = w[c[REST]]
            owner[count] = base + s
            count += 1
    return count


@lean
def _rests(c: Any, modes: Any, port: int) -> bool:
    """Whether another friction holds a port, whose rate is then nothing but rounding."""
    base = 1 + c[FORCES]
    held = False
    for r in range(c[FRICTIONS]):
        held |= modes[base + r] == STICK and c[c[FRICTION_PORT] + r] == port
    return held


@lean
def first_fall(g: Any, owner: Any, count: int, y: Any, u: Any, h: float, q: Any, order: int, p: Any) -> Any:
    """First guard to fall below zero within a step: (mode, theta), or (-1, 1.0).

    Args:
        g, owner, count: of `linear_guards`.
        y, h, q, order: of the step, see `stepper.interpolate`.
        u: the drives at its start and their slopes, shape (2, U).
        p: scratch, shape (at least order + 1,).
    """
    best, mode = 2.0, -1
    size = y.size
    for k in range(count):
        p[0] = g[k, size]
        for i in range(size):
            p[0] += g[k, i] * y[i]
        for d in range(order):
            p[d + 1] = 0.0
        for j in range(u.shape[1]):
            p[0] += g[k, size + 1 + j] * u[0, j]
            p[1] += g[k, size + 1 + j] * u[1, j]
        for i in range(size):
            if g[k, i] != 0.0:
                for d in range(order):
                    p[d + 1] += g[k, i] * q[i, d]
        spread = 0.0
        for d in range(order):
            p[d + 1] *= h
            spread += abs(p[d + 1])
        if p[0] > spread:
            continue
        found = _root(p, order, min(best, 1.0), ROUNDING * spread)
        if found < best:
            best, mode = found, owner[k]
    return mode, min(best, 1.0)


@lean
def _root(p: Any, order: int, end: float, rounding: float) -> float:
    """First theta after 0 at which p has fallen below zero, up to `end`; 2 if it has not. A dip of `rounding` is none:
    what has just begun to slide may seem to turn back at once."""
    before, falling = p[0], p[1] < 0.0
    for j in range(1, len(AT)):
        lo, hi = AT[j - 1], AT[j]
        if lo >= end:
            return 2.0
        now = value(p, order, hi)
        if now < (-rounding if j == 1 else 0.0):
            return _between(p, order, lo, hi, before, now)
        slope = rate(p, order, hi)
        if falling and slope > 0.0:
            low = turn(p, order, lo, hi)
            deep = value(p, order, low)
            if deep < -rounding:
                return _between(p, order, lo, low, before, deep)
        before, falling = now, slope < 0.0
    return 2.0


@lean
def _between(p: Any, order: int, lo: float, hi: float, above: float, below: float) -> float:
    """Root between lo and hi, on its far side: Newton's steps, kept inside by bisection."""
    if above <= 0.0:  # below zero from the start on, but for rounding
        above = 0.0
    at = lo + (hi - lo) * above / (above - below)
    for _ in range(60):
        now = value(p, order, at)
        if now < 0.0:
            hi = at
        else:
            lo = at
        if hi - lo < 1e-14:
            break
        slope = rate(p, order, at)
        new = lo
        if slope < 0.0:
            new = at - now / slope
            if abs(new - at) < 1e-14:  # as near as it gets: look just beyond, so that the other end comes near too
                new = at + 2e-14 if now >= 0.0 else at - 2e-14
        at = new if lo < new < hi else 0.5 * (lo + hi)
    return hi
