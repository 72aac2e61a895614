"""How a sliding disc's friction turns its way, as a stiff step sees it. Compiled.

The slower a disc slides the sooner a push across its way turns it: from rest that is stiffer than any spring.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.simulation.multibody.machine import port_speed
from spacerobot.simulation.reduced.arrays import (
    FORCES,
    FRICTION,
    FRICTION_MATE,
    FRICTION_NORMAL,
    FRICTION_PORT,
    FRICTIONS,
    REST,
)
from spacerobot.simulation.reduced.forces import PRESSED, STICK
from spacerobot.support.jit import lean


@lean
def place(o: Any, port: int) -> int:
    """Where a port stands among those in use; it is added if it does not."""
    for a in range(o.state[0]):
        if o.ports[a] == port:
            return a
    a = o.state[0]
    o.ports[a] = port
    o.state[0] = a + 1
    for b in range(a + 1):
        o.spring[a, b] = o.spring[b, a] = o.damper[a, b] = o.damper[b, a] = 0.0
    return int(a)


@lean
def slides(m: Any, r: int) -> bool:
    """Whether a friction is the lead of a disc that slides, and whose force may be more than nothing in these modes."""
    c = m.c
    pressed = m.modes[0] == PRESSED or c[c[FRICTION_NORMAL] + r] == 0
    return bool(c[c[FRICTION_MATE] + r] >= 0 and m.modes[1 + c[FORCES] + r] != STICK and pressed)


@lean
def _way(m: Any, r: int) -> Any:
    """A sliding disc's force over its speed [N s/m], and the force's direction, two numbers; at the state last seen."""
    c, w = m.c, m.w
    mate = c[c[FRICTION_MATE] + r]
    force = np.hypot(w[c[FRICTION] + r], w[c[FRICTION] + mate])
    speed = np.hypot(port_speed(m, r), port_speed(m, mate)) + w[c[REST]]
    if force == 0.0 or speed == 0.0:
        return 0.0, 0.0, 0.0
    return force / speed, w[c[FRICTION] + r] / force, w[c[FRICTION] + mate] / force


@lean
def turning(m: Any, r: int, o: Any) -> None:
    """What a disc's friction does to the sliding across its way: it turns the sooner the slower the sliding is."""
    c = m.c
    a, b = place(o, c[c[FRICTION_PORT] + r]), place(o, c[c[FRICTION_PORT] + c[c[FRICTION_MATE] + r]])
    rate, ahead, aside = _way(m, r)
    o.damper[a, a] += rate * aside * aside
    o.damper[b, b] += rate * ahead * ahead
    o.damper[a, b] -= rate * ahead * aside
    o.damper[b, a] -= rate * ahead * aside


@lean
def far_astray(m: Any, o: Any, h: float, j: int) -> float:
    """How far the rates across a disc's way are from where its friction turns them, at node j, by its residual.

    What speeds up from rest turns less and less readily: with the slope at the start a pass corrects next to nothing.
    """
    c, worst = m.c, 0.0
    for r in range(c[FRICTIONS]):
        if not slides(m, r):
            continue
        rate, ahead, aside = _way(m, r)
        a, b = place(o, c[c[FRICTION_PORT] + r]), place(o, c[c[FRICTION_PORT] + c[c[FRICTION_MATE] + r]])
        left, give = 0.0, 0.0
        for i in range(m.v.size):
            across = ahead * o.rows[b, i] - aside * o.rows[a, i]
            left += across * o.residual[j, i]
            give += across * (ahead * o.give[b, i] - aside * o.give[a, i])
        worst = max(worst, abs(left) / (1.0 / h + give * rate))
    return float(worst)
