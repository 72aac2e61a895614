"""Guards: one value per mode, positive while the mode holds. Compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.effects.kernel import PARAMETERS
from spacerobot.simulation.reduced.arrays import (
    CONTACT_FORCE,
    EDGE,
    FOLLOWS,
    FORCE,
    FORCES,
    FRICTION,
    FRICTION_MATE,
    FRICTION_PORT,
    FRICTIONS,
    GEOMETRY,
    NONE,
    PARAMETER,
    PRESS,
    RAW,
    REST,
    SENSE,
    STATE_LINEAR,
    STATE_PORT,
    STATES,
    D,
    V,
)
from spacerobot.simulation.reduced.forces import APART, PRESSED, STICK, TINY, beside, call_law, level, onwards
from spacerobot.support.jit import lean


@lean
def disc(x: Any, c: Any, laws: Any, w: Any, r: int, mate: int, m: int, normal: float) -> float:
    """Guard of a friction in two directions: what is left of its limit, or the sliding along its heading.

    What slides backwards no faster than the rates err (REST) is not seen to turn.
    """
    if m == STICK:
        a, b = w[c[FRICTION] + r], w[c[FRICTION] + mate]
        limit = level(x, c, laws, r, TINY, normal, w[c[D] + c[c[FRICTION_PORT] + r]])
        return float(limit * (1.0 + 1e-12) + 1e-300 - np.sqrt(a * a + b * b))
    return float(onwards(c, w, r, mate) + w[c[REST]])


@lean
def guards(x: Any, c: Any, laws: Any, modes: Any, w: Any, out: Any) -> None:
    """One value per mode, positive while the mode holds; call after `evaluate`. Shape (1 + F + R + S,)."""
    forces = c[FORCES]
    normal = 0.0
    if c[PRESS] >= 0:
        d = w[c[D] + c[PRESS]]
        push = -w[c[RAW] + c[CONTACT_FORCE]]
        normal = max(0.0, -w[c[FORCE] + c[CONTACT_FORCE]])
        if modes[0] == APART:
            out[0] = -d
        elif modes[0] == PRESSED:
            out[0] = d if x[c[GEOMETRY] + 3] > 0.5 else push + x[c[GEOMETRY] + 2]
        else:
            out[0] = min(d, -push)
    else:
        out[0] = 1.0
    for j in range(forces):
        e = c[c[EDGE] + j]
        if e < 0:
            out[1 + j] = 1.0
            continue
        sense = c[c[SENSE] + j]
        aux = beside(c, w, j)
        value = call_law(laws[e], w[c[D] + sense], w[c[V] + sense], aux, x, c[PARAMETER] + PARAMETERS * j)
        out[1 + j] = modes[1 + j] * value
    base = 1 + forces
    for r in range(c[FRICTIONS]):
        m = modes[base + r]
        mate = c[c[FRICTION_MATE] + r]
        if mate == FOLLOWS:
            out[base + r] = 1.0
        elif mate != NONE:
            out[base + r] = disc(x, c, laws, w, r, mate, m, normal)
        elif m == STICK:
            f = w[c[FRICTION] + r]
            limit = level(x, c, laws, r, -TINY if f > 0.0 else TINY, normal, w[c[D] + c[c[FRICTION_PORT] + r]])
            out[base + r] = limit * (1.0 + 1e-12) + 1e-300 - abs(f)
        else:
            out[base + r] = m * w[c[V] + c[c[FRICTION_PORT] + r]]
    base += c[FRICTIONS]
    for s in range(c[STATES]):
        out[base + s] = 1.0
        if c[c[STATE_LINEAR] + s] == 0:
            out[base + s] = modes[base + s] * w[c[V] + c[c[STATE_PORT] + s]] + w[c[REST]]
