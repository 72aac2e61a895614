"""Modes in which everything that acts is straight: (v, z)' = A (q, v, z) + b + C u, stepped by its Taylor series.

Compiled. u are the recorded drives, straight from sample to sample (`ports.ramp`).

Between events most mechanisms are such: linear springs, dampers and contact, friction of a steady level, sticking. A
step of degree DEGREE then reaches as far as ten of the general method, and its own series is the dense output.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.effects.kernel import PARAMETERS
from spacerobot.simulation.reduced.arrays import (
    CONSTANT,
    CONTACT_FORCE,
    FORCE_ORDER,
    FORCES,
    FRICTION_NORMAL,
    FRICTION_PORT,
    FRICTION_STEADY,
    FRICTIONS,
    GAIN,
    INPUT_PORT,
    INPUTS,
    LAW,
    LINEAR,
    LIVE_FORCES,
    LIVE_PORTS,
    MASS,
    NATIVE_CONTACT,
    PARAMETER,
    PORT,
    PRESS,
    ROWS,
    SENSE,
    SLIDE,
    SLOPE,
    STATE_LINEAR,
    STATE_NORMAL,
    STATE_PORT,
    STATES,
    W_ROWS,
    YAW,
    D,
    N,
    V,
)
from spacerobot.simulation.reduced.forces import PRESSED, STICK, TINY, call_law, level, remember
from spacerobot.simulation.reduced.ports import kinematics
from spacerobot.support.jit import lean, lean_sum

DEGREE = 16
"""Of the series; 1/17! is 3e-15."""

DRIVEN = 6
"""Of the series from sample to sample of a recorded drive, which are short steps."""

REACH = 20.0
"""Longest step times the bound of the mode's fastest rate, two to four times that rate where there are many. What moves
holds its step by the last term; this keeps what rests, a servo's stiff mode, from growing out of rounding.
"""

SHARE = 1e-4
"""The last term of the series is held to this share of the tolerance. Fits take derivatives of it by differences: at a
hundredth those of a contact of 4e5 N/m crawled, and a hundred times less costs a third more steps.
"""


@lean
def straight(x: Any, c: Any, modes: Any) -> bool:
    """Whether everything that acts in these modes is straight in the state."""
    pressed = c[PRESS] >= 0 and modes[0] == PRESSED
    turning = c[YAW] >= 0
    if pressed and turning:
        return False
    for j in range(c[INPUTS]):
        if turning and swings(c, c[c[INPUT_PORT] + j]):
            return False
    for k in range(c[LIVE_FORCES]):
        j = c[c[FORCE_ORDER] + k]
        if j == c[CONTACT_FORCE]:
            first = c[PARAMETER] + PARAMETERS * j
            plain = c[c[LAW] + j] == NATIVE_CONTACT and x[first + 2] == 1.0 and x[first + 3] == 0.0
            if pressed and not plain:
                return False
        elif c[c[SLOPE] + j] < 0 or (turning and (swings(c, c[c[PORT] + j]) or swings(c, c[c[SENSE] + j]))):
            return False
    for s in range(c[STATES]):
        pressing = pressed and c[c[STATE_NORMAL] + s] == 1
        if c[c[STATE_LINEAR] + s] == 0 or pressing or (turning and swings(c, c[c[STATE_PORT] + s])):
            return False
    base = 1 + c[FORCES]
    for r in range(c[FRICTIONS]):
        p = c[c[FRICTION_PORT] + r]
        if modes[base + r] == STICK:
            if (turning and swings(c, p)) or _coupled(x, c, modes, r):
                return False
        elif c[c[FRICTION_NORMAL] + r] == 1:
            if pressed:
                return False
        elif c[c[FRICTION_STEADY] + r] == 0 or (turning and swings(c, p)):
            return False
    return True


@lean
def swings(c: Any, port: int) -> bool:
    """Whether a port's row would turn with the target."""
    return bool(port == c[PRESS] or port == c[SLIDE])


@lean
def _coupled(x: Any, c: Any, modes: Any, r: int) -> bool:
    """Whether an earlier friction that sticks feels the force of friction r."""
    n, base = c[N], 1 + c[FORCES]
    own = c[ROWS] + c[c[FRICTION_PORT] + r] * n
    for other in range(r):
        if modes[base + other] == STICK:
            row = c[ROWS] + c[c[FRICTION_PORT] + other] * n
            shared = 0.0
            for i in range(n):
                shared += x[own + i] * x[row + i] * x[c[MASS] + i]
            if shared != 0.0:
                return True
    return False


@lean
def system(x: Any, c: Any, laws: Any, y: Any, modes: Any, w: Any, a: Any, held: Any) -> float:
    """Fills a, shape (n + S, 2n + S + 1 + U), with (A, b, C) of these modes; returns the longest step [s].

    Args:
        y: the state, for the side of every kink.
        held: filled for each friction that sticks with its force as a row over (q, v, z, 1, u), shape
            (R, 2n + S + 1 + U).
    """
    n = c[N]
    last = 2 * n + c[STATES]
    rows = c[W_ROWS]
    for i in range(n):
        for j in range(2 * n):
            a[i, j] = x[c[LINEAR] + 2 * n * i + j]
        for j in range(2 * n, last):
            a[i, j] = 0.0
        a[i, last] = x[c[CONSTANT] + i]
        for j in range(c[INPUTS]):
            a[i, last + 1 + j] = x[c[GAIN] + j] * w[rows + c[c[INPUT_PORT] + j] * n + i]
    kinematics(x, c, y, w, c[LIVE_PORTS])
    for k in range(c[LIVE_FORCES]):
        j = c[c[FORCE_ORDER] + k]
        port, sensed = c[c[PORT] + j], c[c[SENSE] + j]
        first = c[PARAMETER] + PARAMETERS * j
        stiffness, damping, rest = 0.0, 0.0, 0.0
        if j == c[CONTACT_FORCE]:
            if modes[0] != PRESSED:
                continue
            stiffness, damping = x[first], x[first + 1]
        else:
            # the slope on this side of the kink; the force itself is continuous there
            d, v = w[c[D] + sensed], w[c[V] + sensed]
            stiffness = call_law(laws[c[c[SLOPE] + j]], d, v, float(modes[1 + j]), x, first)
            rest = call_law(laws[c[c[LAW] + j]], d, v, 0.0, x, first) + stiffness * d
        for i in range(n):
            pull = w[rows + port * n + i]
            if pull != 0.0:
                a[i, last] += pull * rest
                for m in range(n):
                    a[i, m] -= pull * stiffness * w[rows + sensed * n + m]
                    a[i, n + m] -= pull * damping * w[rows + sensed * n + m]
    base = 1 + c[FORCES]
    for r in range(c[FRICTIONS]):
        m = modes[base + r]
        if m == STICK or c[c[FRICTION_NORMAL] + r] == 1:
            continue
        p = c[c[FRICTION_PORT] + r]
        f = -m * level(x, c, laws, r, m * TINY, 0.0, 0.0)
        for i in range(n):
            a[i, last] += w[rows + p * n + i] * f
    memory = _remembered(x, c, laws, modes, w, a)
    _hold(x, c, modes, w, a, held)
    stiff, damp = 0.0, 0.0
    for i in range(n):
        for j in range(a.shape[1]):
            a[i, j] *= x[c[MASS] + i]
        for j in range(n):
            share = x[c[MASS] + j] / x[c[MASS] + i]  # as if every coordinate were scaled by the root of its mass
            stiff += a[i, j] * a[i, j] * share
            damp += a[i, n + j] * a[i, n + j] * share
    rate = stiff**0.25 + damp**0.5 + memory
    return REACH / rate if rate > 0.0 else 1e300


@lean
def _remembered(x: Any, c: Any, laws: Any, modes: Any, w: Any, a: Any) -> float:
    """Adds the laws with a memory to a, their own rows among them; returns a bound of the rates they bring [1/s]."""
    n, first = c[N], 1 + c[FORCES] + c[FRICTIONS]
    last, fastest = 2 * n + c[STATES], 0.0
    for s in range(c[STATES]):
        row, way = c[W_ROWS] + c[c[STATE_PORT] + s] * n, 1.0 * modes[first + s]
        rate, force = remember(x, c, laws, s, 0.0, 0.0, 0.0, way, 1.0)
        by_z = remember(x, c, laws, s, 1.0, 0.0, 0.0, way, 1.0)
        by_d = remember(x, c, laws, s, 0.0, 1.0, 0.0, way, 1.0)
        by_v = remember(x, c, laws, s, 0.0, 0.0, 1.0, way, 1.0)
        give = 0.0
        for j in range(a.shape[1]):
            a[n + s, j] = 0.0
        a[n + s, last], a[n + s, 2 * n + s] = rate, by_z[0] - rate
        for i in range(n):
            pull = w[row + i]
            give += pull * pull * x[c[MASS] + i]
            a[n + s, i], a[n + s, n + i] = pull * (by_d[0] - rate), pull * (by_v[0] - rate)
            a[i, last] += pull * force
            a[i, 2 * n + s] += pull * (by_z[1] - force)
            for j in range(n):
                a[i, j] += pull * (by_d[1] - force) * w[row + j]
                a[i, n + j] += pull * (by_v[1] - force) * w[row + j]
        fastest += abs(by_z[0] - rate) + np.sqrt(give * abs((by_z[1] - force) * (by_v[0] - rate)))
    return fastest


@lean
def _hold(x: Any, c: Any, modes: Any, w: Any, a: Any, held: Any) -> None:
    """Takes out of the generalised forces a what would move a port that sticks, none coupled to another."""
    n, base, rows = c[N], 1 + c[FORCES], c[W_ROWS]
    width = a.shape[1]
    for r in range(c[FRICTIONS]):
        for j in range(width):
            held[r, j] = 0.0
        if modes[base + r] != STICK:
            continue
        row = rows + c[c[FRICTION_PORT] + r] * n
        give = 0.0
        for i in range(n):
            give += w[row + i] * w[row + i] * x[c[MASS] + i]
        if give <= 0.0:
            continue
        for j in range(width):
            along = 0.0
            for i in range(n):
                along += w[row + i] * x[c[MASS] + i] * a[i, j]
            held[r, j] = -along / give
            for i in range(n):
                a[i, j] += w[row + i] * held[r, j]


@lean_sum
def series(y: Any, a: Any, u: Any, h: float, rtol: float, atol: Any, q: Any, term: Any, total: Any) -> float:
    """Fills q, shape (2n + S, degree), with y(t + theta h) = y + h theta (q0 + theta (q1 + ...)); returns h, shortened
    until the last term is within SHARE of the tolerance.

    Args:
        u: the drives at the start of the step and their slopes, shape (2, U).
        term, total: room for (2n + S) and (n + S) numbers: a sum along what lies together is done several at a time.
    """
    size, own, degree = y.size, a.shape[0], q.shape[1]
    n = size - own
    for j in range(size):
        term[j] = y[j]
    for k in range(degree):
        factor = h / (k + 1) if k > 0 else 1.0
        for i in range(own):
            along = a[i, size] if k == 0 else 0.0
            if k < 2:
                for j in range(u.shape[1]):
                    along += a[i, size + 1 + j] * u[k, j]
            for j in range(size):
                along += a[i, j] * term[j]
            total[i] = along
        for i in range(n):
            term[i] = factor * term[n + i]
        for i in range(own):
            term[n + i] = factor * total[i]
        for i in range(size):
            q[i, k] = term[i]
    worst = 0.0
    for i in range(size):
        worst = max(worst, abs(h * q[i, degree - 1]) / (atol[i] + rtol * abs(y[i])))
    if worst <= SHARE:
        return h
    part = 0.95 * (SHARE / worst) ** (1.0 / degree)
    shorten(q, part)
    return h * part


@lean
def shorten(q: Any, part: float) -> None:
    """The same series over the first `part` of its step."""
    factor = part
    for k in range(1, q.shape[1]):
        for i in range(q.shape[0]):
            q[i, k] *= factor
        factor *= part


@lean_sum
def advance(y: Any, h: float, q: Any, new: Any) -> None:
    """State at the end of the step."""
    degree = q.shape[1]
    for i in range(y.size):
        total = q[i, degree - 1]
        for k in range(1, degree):
            total += q[i, degree - 1 - k]
        new[i] = y[i] + h * total
