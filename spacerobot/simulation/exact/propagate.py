"""Collisions from start to end, one after the other, in one compiled call."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.simulation.exact.modes import (
    APART,
    DEFLECTION,
    DEPTH,
    FUNCTIONALS,
    GUARDS,
    PRESSED,
    PUSH,
    RELEASED,
    RUB,
    SLOTS,
    dot,
    fill_guards,
    open_mode,
    slot_of,
)
from spacerobot.simulation.exact.propagator import DEGREE, at, exponential, projected, series, step
from spacerobot.simulation.exact.roots import first_fall
from spacerobot.simulation.polynomial import turn, value
from spacerobot.support.jit import jit, lean, part

(
    FIRST_TOUCH, LAST_SEPARATION, SUMMED, TOUCHES, HAND_BEFORE, TARGET_BEFORE, CLOSING_BEFORE, HAND_AFTER, TARGET_AFTER,
    CLOSING_AFTER, PEAK_FORCE, PEAK_DEFLECTION, FINAL_TARGET, FINAL_HAND, STATUS, STEPS, OUTPUTS,
) = range(17)  # fmt: skip
"""Columns of the result."""

OK, TOO_MANY, NOT_FINITE = 0, 1, 2
MAX_STEPS, MAX_EVENTS = 5_000_000, 20_000


@part
def settled(header: Any, rows: Any, x: Any, contact: int, slide: int, z: Any, w: Any) -> int:
    """The sliding that friction allows in state z: as it is while it slides; stuck, or the way it breaks away."""
    if header[2] == 0 or slide != 0:
        return slide
    a, g, rate, free, c, s = w
    open_mode(header, rows, x, contact, 0, a, g, rate, free, c, s)
    force = dot(g[RUB], z)
    level = x[header[0] + header[1] + 3] * (1.0 + 1e-12)
    if abs(force) <= level:
        return 0
    return -1 if force > 0.0 else 1


@jit
def collide(header: Any, rows: Any, numbers: Any, ends: Any, out: Any) -> None:
    """Runs every collision; fills out, shape (B, OUTPUTS).

    Args:
        header, rows: of the structure, see `Structure.packed`.
        numbers: shape (B, size).
        ends: shape (B,) [s].
        out: filled.
    """
    n, forces, frictional = header[0], header[1], header[2]
    m = 2 * n + 1
    a, e = np.empty((SLOTS, m, m)), np.empty((SLOTS, m, m))
    g, rate = np.empty((SLOTS, FUNCTIONALS, m)), np.empty((SLOTS, FUNCTIONALS, m))
    length = np.empty(SLOTS)
    ready = np.zeros(SLOTS, dtype=np.bool_)
    powered = np.zeros(SLOTS, dtype=np.bool_)
    free, damping, stiff = np.empty((m, m)), np.empty((n, n)), np.empty((n, n))
    term, temp = np.empty((m, m)), np.empty((m, m))
    work = (np.empty((m, m)), np.empty((FUNCTIONALS, m)), np.empty((FUNCTIONALS, m)), free, damping, stiff)
    z, new = np.empty(m), np.empty(m)
    coefficients = np.empty((DEGREE + 1, m))
    polynomial = np.empty(DEGREE + 1)
    which, sign, offset = np.empty(GUARDS, dtype=np.int64), np.empty(GUARDS), np.empty(GUARDS)
    k = n + forces
    for b in range(numbers.shape[0]):
        x, end, o = numbers[b], ends[b], out[b]
        o[:] = np.nan
        o[SUMMED], o[TOUCHES], o[PEAK_FORCE], o[STATUS] = 0.0, 0.0, 0.0, OK
        ready[:] = False
        powered[:] = False
        for i in range(2 * n):
            z[i] = x[k + 4 + n + i]
        z[m - 1] = 1.0
        depth, closing, relative = 0.0, 0.0, 0.0
        for i in range(n):
            depth += rows[forces, i] * z[i]
            closing += rows[forces, i] * z[n + i]
            relative += rows[forces + 1, i] * z[n + i]
        contact, slide = APART, 0
        if depth > 0.0 or (depth == 0.0 and closing > 0.0):
            contact = PRESSED
        if frictional:
            slide = 0 if abs(relative) < 1e-15 else (1 if relative > 0.0 else -1)
        slide = settled(header, rows, x, contact, slide, z, work)
        if contact == PRESSED and x[k] * depth + x[k + 1] * closing + x[k + 2] < 0.0 and header[3] == 0:
            contact = RELEASED
        t, since, events, steps = 0.0, -1.0, 0, 0
        if contact == PRESSED:
            since = 0.0
            _note(rows, forces, n, z, o, HAND_BEFORE)
            o[FIRST_TOUCH] = 0.0
            o[TOUCHES] = 1.0
        deflection = -np.inf
        while t < end:
            slot = slot_of(contact, slide)
            if not ready[slot]:
                length[slot] = open_mode(
                    header, rows, x, contact, slide, a[slot], g[slot], rate[slot], free, damping, stiff
                )
                ready[slot] = True
            guards = fill_guards(header, x, contact, slide, which, sign, offset)
            h = length[slot]
            expanded = False
            if h >= end - t:
                h = end - t
                series(a[slot], h, z, coefficients)
                expanded = True
                at(coefficients, 1.0, new)
            else:
                if not powered[slot]:
                    exponential(a[slot], h, e[slot], term, temp)
                    powered[slot] = True
                step(e[slot], z, new)
            steps += 1
            doubtful = False
            for i in range(guards):
                f = which[i]
                before, after = sign[i] * dot(rate[slot, f], z), sign[i] * dot(rate[slot, f], new)
                below = sign[i] * dot(g[slot, f], new) + offset[i] < 0.0
                gone = before <= 0.0 and sign[i] * dot(g[slot, f], z) + offset[i] <= 0.0
                doubtful = doubtful or below or gone or (before < 0.0 and after > 0.0)
            hit, theta = -1, 2.0
            if doubtful:
                if not expanded:
                    series(a[slot], h, z, coefficients)
                    expanded = True
                for i in range(guards):
                    projected(coefficients, g[slot, which[i]], polynomial)
                    for p in range(DEGREE + 1):
                        polynomial[p] *= sign[i]
                    polynomial[0] += offset[i]
                    found = first_fall(polynomial, 1.0)
                    if found < theta:
                        hit, theta = i, found
            if hit >= 0:
                at(coefficients, theta, new)
            part = theta if hit >= 0 else 1.0
            if contact == PRESSED:
                o[PEAK_FORCE] = max(o[PEAK_FORCE], dot(g[slot, PUSH], z), dot(g[slot, PUSH], new))
            deflection = max(deflection, dot(g[slot, DEFLECTION], z), dot(g[slot, DEFLECTION], new))
            for f in (PUSH, DEFLECTION):
                if f == PUSH and contact != PRESSED:
                    continue
                if dot(rate[slot, f], z) > 0.0 and dot(rate[slot, f], new) < 0.0:
                    if not expanded:
                        series(a[slot], h, z, coefficients)
                        expanded = True
                    projected(coefficients, g[slot, f], polynomial)
                    top = value(polynomial, DEGREE, turn(polynomial, DEGREE, 0.0, part))
                    if f == PUSH:
                        o[PEAK_FORCE] = max(o[PEAK_FORCE], top)
                    else:
                        deflection = max(deflection, top)
            for i in range(m):
                z[i] = new[i]
            if not np.isfinite(z[m - 2]):
                o[STATUS] = NOT_FINITE
                break
            t = t + part * h if hit >= 0 or h < end - t else end
            if steps >= MAX_STEPS or events >= MAX_EVENTS:
                o[STATUS] = TOO_MANY
                break
            if hit < 0:
                continue
            events += 1
            if which[hit] == RUB:
                if slide == 0:  # broke away, against the force that held it
                    slide = 1 if sign[hit] > 0.0 else -1
                else:
                    slide = _at_rest(header, rows, x, contact, z, work)
                continue
            was = contact
            overlap = dot(g[slot, DEPTH], z) > 1e-12
            if was == APART:
                contact = PRESSED
            elif was == PRESSED:
                contact = RELEASED if overlap and header[3] == 0 else APART
            else:
                contact = PRESSED if overlap else APART
            slide = settled(header, rows, x, contact, slide, z, work)
            if contact == PRESSED:
                since = t
                o[TOUCHES] += 1.0
                if o[TOUCHES] == 1.0:
                    o[FIRST_TOUCH] = t
                    _note(rows, forces, n, z, o, HAND_BEFORE)
            elif since >= 0.0:
                o[SUMMED] += t - since
                o[LAST_SEPARATION] = t
                since = -1.0
                _note(rows, forces, n, z, o, HAND_AFTER)
        if since >= 0.0:
            o[SUMMED] += t - since
            o[LAST_SEPARATION] = np.nan
        o[PEAK_DEFLECTION] = deflection
        o[STEPS] = steps
        o[FINAL_HAND], o[FINAL_TARGET] = 0.0, 0.0
        for i in range(n):
            o[FINAL_HAND] += rows[forces + 2, i] * z[n + i]
            o[FINAL_TARGET] += rows[forces + 3, i] * z[n + i]


@lean
def _note(rows: Any, forces: int, n: int, z: Any, o: Any, first: int) -> None:
    """Speeds of hand and target, and of closing, into three columns."""
    for column, row in ((0, forces + 2), (1, forces + 3), (2, forces)):
        total = 0.0
        for i in range(n):
            total += rows[row, i] * z[n + i]
        o[first + column] = total


@part
def _at_rest(header: Any, rows: Any, x: Any, contact: int, z: Any, w: Any) -> int:
    """The friction's mode after its sliding came to rest: stuck, or turned round."""
    n, forces = header[0], header[1]
    relative, give = 0.0, 0.0
    for i in range(n):
        relative += rows[forces + 1, i] * z[n + i]
        give += rows[forces + 1, i] * rows[forces + 1, i] / x[i]
    for i in range(n):  # the last rounding of its rate
        z[n + i] -= relative / give * rows[forces + 1, i] / x[i]
    return settled(header, rows, x, contact, 0, z, w)
