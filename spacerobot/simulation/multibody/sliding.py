"""Which way a disc of friction begins to slide. Compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.simulation.multibody.machine import Machine, rate_at, row_of
from spacerobot.simulation.reduced.arrays import BIAS, FRICTION, FRICTION_MATE, FRICTION_PORT, HEADING
from spacerobot.support.jit import lean

HALVINGS = 200
"""Of the bracket of a multiplier; it narrows to the last bit long before."""


@lean
def _accelerated(m: Any, r: int, mate: int, t: float, y: Any, slope: Any, ahead: float, aside: float) -> Any:
    """Accelerations along a disc's two directions with a heading, and its force along the first."""
    nq, nv = m.q.size, m.v.size
    m.w[m.c[HEADING] + r], m.w[m.c[HEADING] + mate] = ahead, aside
    rate_at(m, t, y, slope)
    one, two = m.w[m.c[BIAS] + m.c[m.c[FRICTION_PORT] + r]], m.w[m.c[BIAS] + m.c[m.c[FRICTION_PORT] + mate]]
    first, second = row_of(m, r), row_of(m, mate)
    for i in range(nv):
        one += m.w[first + i] * slope[nq + i]
        two += m.w[second + i] * slope[nq + i]
    return one, two, m.w[m.c[FRICTION] + r]


@lean
def start_heading(m: Machine, r: int, t: float, y: Any, slope: Any) -> None:
    """Sets the heading of friction `r` and its mate, at rest and about to slide in state y.

    The sliding accelerates by a = b + W f where nothing else gives way, and the force opposes it with all that its
    limit has. So a is tried with no force and with a force along either axis, which says what b and W are.

    Args:
        m: its modes have `r` sliding; its heading is set.
        r: of the lead.
        t, y: time [s] and ambient state.
        slope: overwritten, shape of y.
    """
    c, w = m.c, m.w
    mate = c[c[FRICTION_MATE] + r]
    b0, b1, _ = _accelerated(m, r, mate, t, y, slope, 0.0, 0.0)
    one0, one1, force = _accelerated(m, r, mate, t, y, slope, 1.0, 0.0)
    two0, two1, _ = _accelerated(m, r, mate, t, y, slope, 0.0, 1.0)
    limit = abs(force)
    size = np.hypot(b0, b1)
    if limit == 0.0 or size == 0.0:
        w[c[HEADING] + r] = b0 / size if size > 0.0 else 0.0
        w[c[HEADING] + mate] = b1 / size if size > 0.0 else 0.0
        return
    f0, f1 = against(
        b0, b1, (b0 - one0) / limit, (b0 - two0) / limit, (b1 - one1) / limit, (b1 - two1) / limit, limit
    )  # fmt: skip
    w[c[HEADING] + r], w[c[HEADING] + mate] = -f0 / limit, -f1 / limit


@lean
def _opposing(b0: float, b1: float, g00: float, g01: float, g10: float, g11: float, m: float) -> Any:
    """-(give + m 1)^-1 b."""
    g00, g11 = g00 + m, g11 + m
    det = g00 * g11 - g01 * g10
    return (g01 * b1 - g11 * b0) / det, (g10 * b0 - g00 * b1) / det


@lean
def against(b0: float, b1: float, g00: float, g01: float, g10: float, g11: float, limit: float) -> Any:
    """The force of size `limit` that opposes the acceleration b + give f which it leaves, two numbers.

    It is -(give + m 1)^-1 b with the m > 0 that gives it its size: b + give f = -m f. Maximum dissipation over the
    disc; Moreau (1988), Unilateral contact and dry friction in finite freedom dynamics, section 5.

    Args:
        b0, b1: acceleration without the force, more than a force below the limit could undo.
        g00, g01, g10, g11: acceleration per force, symmetric and positive, by rows.
        limit: [N], positive.
    """
    low, high = 0.0, np.hypot(b0, b1) / limit
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        f0, f1 = _opposing(b0, b1, g00, g01, g10, g11, middle)
        if np.hypot(f0, f1) > limit:
            low = middle
        else:
            high = middle
        if high - low <= 1e-15 * high:
            break
    f0, f1 = _opposing(b0, b1, g00, g01, g10, g11, high)
    share = limit / np.hypot(f0, f1)
    return f0 * share, f1 * share
