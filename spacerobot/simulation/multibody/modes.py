"""Modes of a machine at a state: contact, edges, what sticks and what slides which way. Compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.simulation.multibody.kernel import solve
from spacerobot.simulation.multibody.layout import SPLIT, scratch_inside
from spacerobot.simulation.multibody.machine import SLACK, port_speed, rate_at, row_of
from spacerobot.simulation.multibody.sliding import start_heading
from spacerobot.simulation.reduced.arrays import (
    CONTACT_FORCE,
    FOLLOWS,
    FORCE,
    FORCES,
    FRICTION,
    FRICTION_MATE,
    FRICTION_NORMAL,
    FRICTION_PORT,
    FRICTIONS,
    GEOMETRY,
    HEADING,
    PRESS,
    RAW,
    REST,
    STATE_PORT,
    STATES,
    D,
    V,
)
from spacerobot.simulation.reduced.events import fix_edges
from spacerobot.simulation.reduced.forces import (
    APART,
    AT_REST,
    PRESSED,
    RELEASED,
    STICK,
    TINY,
    direction,
    level,
    onwards,
)
from spacerobot.support.jit import lean


@lean
def _set(m: Any, r: int, mode: int) -> None:
    """The mode of a friction, and of its mate."""
    base, mate = 1 + m.c[FORCES], m.c[m.c[FRICTION_MATE] + r]
    m.modes[base + r] = mode
    if mate >= 0:
        m.modes[base + mate] = mode


@lean
def _sliding(m: Any, r: int, mate: int) -> float:
    """Speed of what slides in two directions, at the state last evaluated."""
    return float(np.hypot(port_speed(m, r), port_speed(m, mate)))


@lean
def _sideways(m: Any, r: int, mate: int) -> float:
    """Speed across its heading of what slides in two directions."""
    return float(abs(port_speed(m, mate) * m.w[m.c[HEADING] + r] - port_speed(m, r) * m.w[m.c[HEADING] + mate]))


@lean
def _head(m: Any, r: int, mate: int, speed: float) -> None:
    """Turns a heading to where the disc slides; to nowhere at rest."""
    m.w[m.c[HEADING] + r] = port_speed(m, r) / speed if speed > 0.0 else 0.0
    m.w[m.c[HEADING] + mate] = port_speed(m, mate) / speed if speed > 0.0 else 0.0


@lean
def turn(m: Any) -> None:
    """Turns the headings of what slides in two directions to where it slides at the state last evaluated.

    What has been carried through a stop keeps its heading until its guard has seen it.
    """
    c, w = m.c, m.w
    for r in range(c[FRICTIONS]):
        mate = c[c[FRICTION_MATE] + r]
        if mate >= 0 and m.modes[1 + c[FORCES] + r] != STICK and onwards(c, w, r, mate) > 0.0:
            w[c[HEADING] + r], w[c[HEADING] + mate] = direction(c, w, r, mate)


@lean
def _start_friction(m: Any, r: int) -> None:
    mate = m.c[m.c[FRICTION_MATE] + r]
    if mate == FOLLOWS:
        return
    if mate >= 0:
        speed = _sliding(m, r, mate)
        _set(m, r, STICK if speed < AT_REST else 1)
        _head(m, r, mate, speed)
        return
    rate = port_speed(m, r)
    _set(m, r, STICK if abs(rate) < AT_REST else (1 if rate > 0.0 else -1))


@lean
def _break_away(m: Any, r: int) -> None:
    """Lets a friction that sticks slide, the way that the state last evaluated drives it."""
    mate = m.c[m.c[FRICTION_MATE] + r]
    _set(m, r, -1 if mate < 0 and m.w[m.c[FRICTION] + r] > 0.0 else 1)


@lean
def _excess(m: Any, r: int) -> float:
    """How far the force that holds friction `r` exceeds its limit [N], at the state last evaluated."""
    c, w = m.c, m.w
    mate, force, normal = c[c[FRICTION_MATE] + r], w[c[FRICTION] + r], 0.0
    if mate >= 0:
        force = np.hypot(force, w[c[FRICTION] + mate])
    if c[c[FRICTION_NORMAL] + r] == 1:
        normal = max(0.0, -w[c[FORCE] + c[CONTACT_FORCE]])
    d = w[c[D] + c[c[FRICTION_PORT] + r]]
    limit = level(m.x, c, m.laws, r, -TINY if force > 0.0 else TINY, normal, d)
    return float(abs(force) - limit * (1.0 + 1e-12) - m.settings[SLACK])


@lean
def settle(m: Any, t: float, y: Any, slope: Any) -> None:
    """Lets every stuck port whose friction exceeds its limit slide; repeated until consistent."""
    c, base = m.c, 1 + m.c[FORCES]
    for _ in range(c[FRICTIONS] + 1):
        for r in range(c[FRICTIONS]):
            mate = c[c[FRICTION_MATE] + r]
            if mate >= 0 and m.modes[base + r] != STICK and _sliding(m, r, mate) <= AT_REST:
                start_heading(m, r, t, y, slope)
        rate_at(m, t, y, slope)
        worst, most = -1, 0.0
        for r in range(c[FRICTIONS]):
            if m.modes[base + r] == STICK and c[c[FRICTION_MATE] + r] != FOLLOWS:
                over = _excess(m, r)
                if over > most:
                    worst, most = r, over
        if worst < 0:
            return
        _break_away(m, worst)


@lean
def start(m: Any, t: float, y: Any, slope: Any) -> None:
    """Modes that fit the state y."""
    c, w = m.c, m.w
    for i in range(m.modes.size):
        m.modes[i] = 1
    m.modes[0] = APART
    rate_at(m, t, y, slope)
    if c[PRESS] >= 0:
        gap, speed = w[c[D] + c[PRESS]], w[c[V] + c[PRESS]]
        if gap > AT_REST or (gap > -AT_REST and speed > 0.0):
            m.modes[0] = PRESSED
    for r in range(c[FRICTIONS]):
        _start_friction(m, r)
    for s in range(c[STATES]):
        m.modes[1 + c[FORCES] + c[FRICTIONS] + s] = -1 if w[c[V] + c[c[STATE_PORT] + s]] < 0.0 else 1
    settle(m, t, y, slope)
    turn(m)
    if m.modes[0] == PRESSED and m.x[c[GEOMETRY] + 3] < 0.5:
        push = m.x[c[GEOMETRY] + 2] - w[c[RAW] + c[CONTACT_FORCE]]
        m.modes[0] = RELEASED if push < -1e-9 * m.settings[SLACK] else PRESSED
    fix_edges(m.x, c, m.laws, m.modes, w)


@lean
def _switch_contact(m: Any) -> None:
    c = m.c
    over = m.w[c[D] + c[PRESS]] > AT_REST
    if m.modes[0] == APART:
        m.modes[0] = PRESSED
    elif m.modes[0] == PRESSED:
        m.modes[0] = RELEASED if over and m.x[c[GEOMETRY] + 3] < 0.5 else APART
    else:
        m.modes[0] = PRESSED if over else APART
    for r in range(c[FRICTIONS]):
        if c[c[FRICTION_NORMAL] + r] == 1:
            _start_friction(m, r)
            if m.modes[0] != PRESSED:
                _set(m, r, 1)


@lean
def _switch_friction(m: Any, r: int, y: Any) -> None:
    mate = m.c[m.c[FRICTION_MATE] + r]
    if m.modes[1 + m.c[FORCES] + r] == STICK:
        _break_away(m, r)
        return
    if mate >= 0 and _sideways(m, r, mate) > m.w[m.c[REST]]:
        _head(m, r, mate, _sliding(m, r, mate))  # it did not stop, but turned by more than a right angle in a step
        return
    _halt(m, r, mate, y)
    _set(m, r, STICK)


@lean
def _halt(m: Any, r: int, mate: int, y: Any) -> None:
    """Takes the last rounding of what slid out of the velocities in y; whether it can stick is seen after."""
    nq, nv = m.q.size, m.v.size
    scratch = scratch_inside(m.ints, m.work)
    one, two = row_of(m, r), row_of(m, mate) if mate >= 0 else -1
    kick, other = scratch.held[0], scratch.held[1 if mate >= 0 else 0]
    speed, across, g00, g01, g11 = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(nv):
        kick[i] = m.w[one + i]
    solve(scratch.factor, m.ints[SPLIT], kick)
    if two >= 0:
        for i in range(nv):
            other[i] = m.w[two + i]
        solve(scratch.factor, m.ints[SPLIT], other)
        for i in range(nv):
            g01 += m.w[one + i] * other[i]
            g11 += m.w[two + i] * other[i]
            across += m.w[two + i] * y[nq + i]
    for i in range(nv):
        g00 += m.w[one + i] * kick[i]
        speed += m.w[one + i] * y[nq + i]
    tiny = 1e-12 * max(g00, g11)
    share = g01 / g00 if g00 > tiny else 0.0
    pivot = g11 - share * g01
    b = (across - share * speed) / pivot if pivot > tiny else 0.0
    a = (speed - g01 * b) / g00 if g00 > tiny else 0.0
    for i in range(nv):
        y[nq + i] -= a * kick[i]
        if two >= 0:
            y[nq + i] -= b * other[i]


@lean
def switch(m: Any, i: int, t: float, y: Any, slope: Any) -> None:
    """Changes mode i after its guard fell to zero at state y, and what follows from it."""
    rate_at(m, t, y, slope)
    if i == 0:
        _switch_contact(m)
    elif i <= m.c[FORCES] or i > m.c[FORCES] + m.c[FRICTIONS]:
        m.modes[i] = -m.modes[i]
    else:
        _switch_friction(m, i - 1 - m.c[FORCES], y)
    settle(m, t, y, slope)
