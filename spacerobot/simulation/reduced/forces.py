"""Forces at the ports of the reduced model, set-valued friction among them. Compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.effects.kernel import PARAMETERS
from spacerobot.effects.laws import contact_force
from spacerobot.simulation.reduced.arrays import (
    ASIDE,
    AUX,
    BIAS,
    CONTACT_FORCE,
    FOLLOWS,
    FORCE,
    FORCE_ORDER,
    FORCES,
    FRICTION,
    FRICTION_LAW,
    FRICTION_MATE,
    FRICTION_NORMAL,
    FRICTION_PARAMETER,
    FRICTION_PORT,
    FRICTIONS,
    HEADING,
    INPUTS,
    LAW,
    MASS,
    MATRIX,
    NATIVE_CONTACT,
    NATIVE_DAMPER,
    NATIVE_SPRING,
    NONE,
    PARAMETER,
    PORT,
    RAW,
    REMEMBERED,
    REST,
    SENSE,
    STATE_FIRST,
    STATE_FORCE,
    STATE_NORMAL,
    STATE_PARAMETER,
    STATE_PORT,
    STATE_RATE,
    STATES,
    STUCK,
    TAU,
    VECTOR,
    W_ROWS,
    Z_RATE,
    D,
    N,
    V,
    Z,
)
from spacerobot.simulation.reduced.ports import drive
from spacerobot.support.jit import call_law as _call_law
from spacerobot.support.jit import call_memory as _call_memory
from spacerobot.support.jit import inlined, lean

call_law, call_memory = _call_law(), _call_memory()
native_contact = lean(contact_force)

APART, PRESSED, RELEASED = 0, 1, 2
"""Contact modes: surfaces apart; force carried; overlapping on paper but the contact force has ended."""

SLIP_MINUS, STICK, SLIP_PLUS = -1, 0, 1
TINY = 1e-300

AT_REST = 1e-12
"""Penetration [m] and rate [m/s, rad/s] taken for zero when modes are chosen."""


@lean
def level(x: Any, c: Any, laws: Any, r: int, v: float, normal: float, d: float) -> float:
    """Largest magnitude of friction r at displacement d, sliding at rate v (its sign is the direction)."""
    load = normal if c[c[FRICTION_NORMAL] + r] == 1 else 1.0
    return call_law(laws[c[c[FRICTION_LAW] + r]], v, load, d, x, c[FRICTION_PARAMETER] + PARAMETERS * r)


@inlined
def beside(c: Any, w: Any, j: int) -> float:
    """What law j reads beside its own port: the rate of another one, or the speed across two."""
    if c[c[AUX] + j] < 0:
        return 0.0
    aux = w[c[V] + c[c[AUX] + j]]
    if c[c[ASIDE] + j] < 0:
        return aux
    other = w[c[V] + c[c[ASIDE] + j]]
    return np.sqrt(aux * aux + other * other)


@inlined
def say(x: Any, c: Any, laws: Any, modes: Any, w: Any, j: int) -> float:
    """What law j says at the present displacements and rates, kept in RAW; and what acts, kept in FORCE."""
    sense = c[c[SENSE] + j]
    d, v = w[c[D] + sense], w[c[V] + sense]
    law = c[c[LAW] + j]
    first = c[PARAMETER] + PARAMETERS * j
    if law == NATIVE_SPRING:
        f = -x[first] * d
    elif law == NATIVE_DAMPER:
        f = -x[first] * v
    else:
        aux = beside(c, w, j)
        if law == NATIVE_CONTACT:
            # a tuple: a view of x would cost more than the law, for its reference count
            f = native_contact(d, v, aux, (x[first], x[first + 1], x[first + 2], x[first + 3]))
        else:
            f = call_law(laws[law], d, v, aux, x, first)
    w[c[RAW] + j] = f
    if j == c[CONTACT_FORCE] and modes[0] != PRESSED:
        f = 0.0
    w[c[FORCE] + j] = f
    return f


@lean
def onwards(c: Any, w: Any, r: int, mate: int) -> float:
    """Rate along its heading of a disc that slides."""
    along, across = w[c[V] + c[c[FRICTION_PORT] + r]], w[c[V] + c[c[FRICTION_PORT] + mate]]
    return float(along * w[c[HEADING] + r] + across * w[c[HEADING] + mate])


@lean
def direction(c: Any, w: Any, r: int, mate: int) -> Any:
    """Where a disc slides, two numbers: along its rates; along its heading where these are next to nothing.

    The rates of what slides slower than the rates' own errors (REST) point anywhere, and the force with them. Where
    the sliding has been carried through a stop within a step, the force along the heading stays what it was before: the
    guard then falls smoothly through zero.
    """
    along, across = w[c[V] + c[c[FRICTION_PORT] + r]], w[c[V] + c[c[FRICTION_PORT] + mate]]
    ahead, aside = w[c[HEADING] + r], w[c[HEADING] + mate]
    if np.hypot(along, across) <= AT_REST:
        return ahead, aside
    push = w[c[REST]] - 2.0 * min(onwards(c, w, r, mate), 0.0)
    ahead, aside = along + push * ahead, across + push * aside
    size = np.hypot(ahead, aside)
    return ahead / size, aside / size


@lean
def rub(x: Any, c: Any, laws: Any, w: Any, r: int, mate: int, normal: float) -> None:
    """Sliding across two directions: a force of the level, against the sliding (Coulomb's disc), added to TAU."""
    n, p, q = c[N], c[c[FRICTION_PORT] + r], c[c[FRICTION_PORT] + mate]
    ahead, aside = direction(c, w, r, mate)
    f = -level(x, c, laws, r, max(np.hypot(w[c[V] + p], w[c[V] + q]), TINY), normal, w[c[D] + p])
    w[c[FRICTION] + r], w[c[FRICTION] + mate] = f * ahead, f * aside
    for i in range(n):
        w[c[TAU] + i] += f * (ahead * w[c[W_ROWS] + p * n + i] + aside * w[c[W_ROWS] + q * n + i])


@lean
def remember(x: Any, c: Any, laws: Any, s: int, z: float, d: float, v: float, way: float, normal: float) -> Any:
    """Rate and force of state s at these values."""
    first = c[STATE_PARAMETER] + c[c[STATE_FIRST] + s]
    load = normal if c[c[STATE_NORMAL] + s] == 1 else 1.0
    rate = call_memory(laws[c[c[STATE_RATE] + s]], (z, 0.0, d, v, way, load), x, first)
    return rate, call_memory(laws[c[c[STATE_FORCE] + s]], (z, rate, d, v, way, load), x, first)


@inlined
def act(x: Any, c: Any, laws: Any, t: float, modes: Any, u: Any, w: Any, count: int) -> int:
    """Adds what the first `count` forces of FORCE_ORDER, drives and frictions do to TAU; returns how many stick.

    Reads displacements and rates of the ports; fills RAW, FORCE, FRICTION (of the sliding) and STUCK (which are
    not), Z_RATE and REMEMBERED. modes = (contact, edge signs (F), frictions (R), ways of states (S)).
    """
    n = c[N]
    normal = 0.0
    for k in range(count):
        j = c[c[FORCE_ORDER] + k]
        f = say(x, c, laws, modes, w, j)
        if j == c[CONTACT_FORCE]:
            normal = max(0.0, -f)
        if f != 0.0:
            row = c[W_ROWS] + c[c[PORT] + j] * n
            for i in range(n):
                w[c[TAU] + i] += w[row + i] * f
    if c[INPUTS] > 0:
        drive(x, c, t, u, w)
    base = 1 + c[FORCES]
    for s in range(c[STATES]):
        p, way = c[c[STATE_PORT] + s], 1.0 * modes[base + c[FRICTIONS] + s]
        rate, f = remember(x, c, laws, s, w[c[Z] + s], w[c[D] + p], w[c[V] + p], way, normal)
        w[c[Z_RATE] + s], w[c[REMEMBERED] + s] = rate, f
        for i in range(n):
            w[c[TAU] + i] += w[c[W_ROWS] + p * n + i] * f
    stuck = 0
    for r in range(c[FRICTIONS]):
        m = modes[base + r]
        if m == STICK:
            w[c[STUCK] + stuck] = r
            stuck += 1
            continue
        mate = c[c[FRICTION_MATE] + r]
        if mate != NONE:
            if mate != FOLLOWS:
                rub(x, c, laws, w, r, mate, normal)
            continue
        p = c[c[FRICTION_PORT] + r]
        speed = m * max(m * w[c[V] + p], TINY)
        f = -m * level(x, c, laws, r, speed, normal, w[c[D] + p])
        w[c[FRICTION] + r] = f
        for i in range(n):
            w[c[TAU] + i] += w[c[W_ROWS] + p * n + i] * f
    return stuck


@lean
def stick(x: Any, c: Any, stuck: int, w: Any) -> None:
    """Forces that keep the stuck ports from accelerating: J M^-1 J^T f = -(J M^-1 tau + bias)."""
    n = c[N]
    for a in range(stuck):
        pa = c[c[FRICTION_PORT] + int(w[c[STUCK] + a])]
        total = w[c[BIAS] + pa]
        for i in range(n):
            total += w[c[W_ROWS] + pa * n + i] * x[c[MASS] + i] * w[c[TAU] + i]
        w[c[VECTOR] + a] = -total
        for b in range(stuck):
            pb = c[c[FRICTION_PORT] + int(w[c[STUCK] + b])]
            coupling = 0.0
            for i in range(n):
                coupling += w[c[W_ROWS] + pa * n + i] * x[c[MASS] + i] * w[c[W_ROWS] + pb * n + i]
            w[c[MATRIX] + a * stuck + b] = coupling
    for a in range(stuck):  # elimination without pivoting: the matrix is symmetric positive semidefinite
        pivot = w[c[MATRIX] + a * stuck + a]
        if pivot <= 1e-14:
            continue
        for b in range(a + 1, stuck):
            ratio = w[c[MATRIX] + b * stuck + a] / pivot
            for e in range(a, stuck):
                w[c[MATRIX] + b * stuck + e] -= ratio * w[c[MATRIX] + a * stuck + e]
            w[c[VECTOR] + b] -= ratio * w[c[VECTOR] + a]
    for k in range(stuck):
        a = stuck - 1 - k
        pivot = w[c[MATRIX] + a * stuck + a]
        value = w[c[VECTOR] + a]
        for b in range(a + 1, stuck):
            value -= w[c[MATRIX] + a * stuck + b] * w[c[VECTOR] + b]
        # a second friction at the same port finds a zero pivot and carries nothing; the first carries all
        w[c[VECTOR] + a] = value / pivot if pivot > 1e-14 else 0.0
    for a in range(stuck):
        r = int(w[c[STUCK] + a])
        f = w[c[VECTOR] + a]
        w[c[FRICTION] + r] = f
        p = c[c[FRICTION_PORT] + r]
        for i in range(n):
            w[c[TAU] + i] += w[c[W_ROWS] + p * n + i] * f
