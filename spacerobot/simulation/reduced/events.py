"""Events: guards bracketed inside every step, located by safeguarded secants; what mode follows. Compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.effects.kernel import PARAMETERS
from spacerobot.simulation.reduced.arrays import (
    CONTACT_FORCE,
    EDGE,
    FORCE,
    FORCES,
    FRICTION,
    FRICTION_PORT,
    FRICTIONS,
    GEOMETRY,
    LIVE_PORTS,
    MASS,
    PARAMETER,
    PRESS,
    RAW,
    SENSE,
    STATE_PORT,
    STATES,
    W_ROWS,
    D,
    N,
    V,
)
from spacerobot.simulation.reduced.forces import APART, PRESSED, RELEASED, STICK, TINY, beside, call_law, level
from spacerobot.simulation.reduced.guards import guards
from spacerobot.simulation.reduced.motion import accelerate, sense
from spacerobot.simulation.reduced.ports import kinematics
from spacerobot.simulation.reduced.stepper import interpolate
from spacerobot.support.jit import lean, part

AT = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Where in a step guards are looked at; not just after its start, where what begins to slide may seem to turn back."""
SUBSAMPLES = len(AT) - 1
LOW = 0.2
"""A dip is looked into where its parabola falls below so much of the lowest sample."""


@lean
def guard_at(
    x: Any,
    c: Any,
    laws: Any,
    t: float,
    y: Any,
    h: float,
    q: Any,
    order: int,
    theta: float,
    modes: Any,
    u: Any,
    w: Any,
    temp: Any,
    slope: Any,
    g: Any,
) -> None:
    """Guards at t + theta h, into g."""
    interpolate(y, h, q, order, theta, temp)
    sense(x, c, laws, t + theta * h, temp, modes, u, w, slope)
    guards(x, c, laws, modes, w, g)


@lean
def find_event(
    x: Any,
    c: Any,
    laws: Any,
    t: float,
    y: Any,
    h: float,
    q: Any,
    order: int,
    modes: Any,
    u: Any,
    w: Any,
    temp: Any,
    slope: Any,
    samples: Any,
    rates: Any,
) -> Any:
    """First guard to fall below zero inside the step: (index, theta), or (-1, 1.0).

    Guards are sampled at the points AT; a dip between samples is caught by the sign of the contact's rate (an extremum
    of the gap) and, for the others, by the vertices of parabolas through the three points around the lowest.
    """
    count = samples.shape[1]
    press = c[PRESS]
    for j in range(SUBSAMPLES + 1):
        guard_at(x, c, laws, t, y, h, q, order, AT[j], modes, u, w, temp, slope, samples[j])
        rates[j] = w[c[V] + press] if press >= 0 else 0.0
    best_theta = 2.0
    best = -1
    for i in range(count):
        lo, hi = -1.0, -1.0
        above, below = 0.0, 0.0
        for j in range(1, SUBSAMPLES + 1):
            if samples[j, i] < 0.0:
                lo, hi = AT[j - 1], AT[j]
                above, below = samples[j - 1, i], samples[j, i]
                break
            dip = -1.0
            if i == 0 and press >= 0 and modes[0] != PRESSED:
                if rates[j - 1] > 0.0 and rates[j] < 0.0:
                    dip = _extremum(
                        x,
                        c,
                        laws,
                        t,
                        y,
                        h,
                        q,
                        order,
                        AT[j - 1],
                        AT[j],
                        modes,
                        u,
                        w,
                        temp,
                        slope,
                    )
                    guard_at(x, c, laws, t, y, h, q, order, dip, modes, u, w, temp, slope, samples[SUBSAMPLES + 1])
            elif j < SUBSAMPLES and samples[j, i] <= samples[j - 1, i] and samples[j, i] <= samples[j + 1, i]:
                p0, p1, p2 = AT[j - 1], AT[j], AT[j + 1]
                g0, g1, g2 = samples[j - 1, i], samples[j, i], samples[j + 1, i]
                for _ in range(6):  # parabolas, each through the three points around the lowest so far
                    left, right = (g1 - g0) / (p1 - p0), (g2 - g1) / (p2 - p1)
                    curve = (right - left) / (p2 - p0)
                    if not curve > 0.0:
                        break
                    at = 0.5 * (p0 + p1 - left / curve)
                    low = g1 - curve * (at - p1) * (at - p1)
                    if low >= LOW * g1 or abs(at - p1) < 1e-6 or not p0 < at < p2:
                        break
                    guard_at(x, c, laws, t, y, h, q, order, at, modes, u, w, temp, slope, samples[SUBSAMPLES + 1])
                    new = samples[SUBSAMPLES + 1, i]
                    if new < 0.0:
                        dip = at
                        break
                    if new < g1:
                        if at < p1:
                            p2, g2 = p1, g1
                        else:
                            p0, g0 = p1, g1
                        p1, g1 = at, new
                    elif at < p1:
                        p0, g0 = at, new
                    else:
                        p2, g2 = at, new
            if dip > 0.0 and samples[SUBSAMPLES + 1, i] < 0.0:
                lo, hi = AT[j - 1], dip
                above, below = samples[j - 1, i], samples[SUBSAMPLES + 1, i]
                break
        if hi < 0.0 or lo >= best_theta:
            continue
        # Illinois, with a bisection every third time; ends on the far side of the root
        scale = max(abs(above), abs(below))
        side = 0
        for n in range(90):
            part = above / (above - below) if above > 0.0 else 0.0
            mid = lo + (hi - lo) * part if n % 3 < 2 and 0.0 < part < 1.0 else 0.5 * (lo + hi)
            guard_at(x, c, laws, t, y, h, q, order, mid, modes, u, w, temp, slope, samples[SUBSAMPLES + 1])
            value = samples[SUBSAMPLES + 1, i]
            if value < 0.0:
                hi, below = mid, value
                if side < 0:
                    above *= 0.5
                side = -1
                if -value <= 1e-14 * scale:
                    break
            else:
                lo, above = mid, value
                if side > 0:
                    below *= 0.5
                side = 1
            if hi - lo < 1e-13:
                break
        if hi < best_theta:
            best_theta, best = hi, i
    if best < 0:
        return -1, 1.0
    return best, best_theta


@lean
def _extremum(
    x: Any,
    c: Any,
    laws: Any,
    t: float,
    y: Any,
    h: float,
    q: Any,
    order: int,
    lo: float,
    hi: float,
    modes: Any,
    u: Any,
    w: Any,
    temp: Any,
    slope: Any,
) -> float:
    """Where the contact's rate changes sign from positive to negative: the deepest point."""
    press = c[PRESS]
    for _ in range(40):
        mid = 0.5 * (lo + hi)
        interpolate(y, h, q, order, mid, temp)
        kinematics(x, c, temp, w, c[LIVE_PORTS])
        if w[c[V] + press] > 0.0:
            lo = mid
        else:
            hi = mid
    return 0.5 * (lo + hi)


@lean
def switch(x: Any, c: Any, laws: Any, i: int, t: float, y: Any, modes: Any, u: Any, w: Any, slope: Any) -> None:
    """Changes mode i after its guard fell to zero at state y."""
    n = c[N]
    forces = c[FORCES]
    accelerate(x, c, laws, t, y, modes, u, w, slope)
    if i == 0:
        d = w[c[D] + c[PRESS]]
        if modes[0] == APART:
            modes[0] = PRESSED
        elif modes[0] == PRESSED:
            modes[0] = RELEASED if d > 1e-12 and x[c[GEOMETRY] + 3] < 0.5 else APART
        else:
            modes[0] = PRESSED if d > 1e-12 else APART
        return
    if i <= forces:
        modes[i] = -modes[i]
        return
    r = i - 1 - forces
    if r >= c[FRICTIONS]:
        modes[i] = -modes[i]
        return
    p = c[c[FRICTION_PORT] + r]
    if modes[i] == STICK:
        modes[i] = -1 if w[c[FRICTION] + r] > 0.0 else 1
        return
    share = 0.0  # the sliding ended: remove the last rounding of its rate, then see whether it can stick
    for j in range(n):
        share += w[c[W_ROWS] + p * n + j] * w[c[W_ROWS] + p * n + j] * x[c[MASS] + j]
    if share > 0.0:
        kick = w[c[V] + p] / share
        for j in range(n):
            y[n + j] -= kick * w[c[W_ROWS] + p * n + j] * x[c[MASS] + j]
    modes[i] = STICK
    settle(x, c, laws, t, y, modes, u, w, slope)


@lean
def settle(x: Any, c: Any, laws: Any, t: float, y: Any, modes: Any, u: Any, w: Any, slope: Any) -> None:
    """Lets every stuck port whose friction exceeds its limit slide; repeated until consistent."""
    base = 1 + c[FORCES]
    for _ in range(c[FRICTIONS] + 1):
        accelerate(x, c, laws, t, y, modes, u, w, slope)
        normal = 0.0
        if c[PRESS] >= 0:
            normal = max(0.0, -w[c[FORCE] + c[CONTACT_FORCE]])
        worst, excess = -1, 0.0
        for r in range(c[FRICTIONS]):
            if modes[base + r] == STICK:
                f = w[c[FRICTION] + r]
                d = w[c[D] + c[c[FRICTION_PORT] + r]]
                over = abs(f) - level(x, c, laws, r, -TINY if f > 0.0 else TINY, normal, d) * (1.0 + 1e-12)
                if over > excess:
                    worst, excess = r, over
        if worst < 0:
            return
        modes[base + worst] = -1 if w[c[FRICTION] + worst] > 0.0 else 1


@part
def start_modes(x: Any, c: Any, laws: Any, t: float, y: Any, u: Any, w: Any, slope: Any) -> Any:
    """Modes that fit the state y."""
    forces = c[FORCES]
    modes = np.zeros(1 + forces + c[FRICTIONS] + c[STATES], dtype=np.int64)
    kinematics(x, c, y, w, c[LIVE_PORTS])
    if c[PRESS] >= 0:
        d, v = w[c[D] + c[PRESS]], w[c[V] + c[PRESS]]
        if d > 0.0 or (d == 0.0 and v > 0.0):
            modes[0] = PRESSED
    for r in range(c[FRICTIONS]):
        v = w[c[V] + c[c[FRICTION_PORT] + r]]
        modes[1 + forces + r] = STICK if abs(v) < 1e-15 else (1 if v > 0.0 else -1)
    for s in range(c[STATES]):
        modes[1 + forces + c[FRICTIONS] + s] = -1 if w[c[V] + c[c[STATE_PORT] + s]] < 0.0 else 1
    for j in range(forces):
        modes[1 + j] = 1
    settle(x, c, laws, t, y, modes, u, w, slope)
    if modes[0] == PRESSED and -w[c[RAW] + c[CONTACT_FORCE]] + x[c[GEOMETRY] + 2] < 0.0 and x[c[GEOMETRY] + 3] < 0.5:
        modes[0] = RELEASED
    fix_edges(x, c, laws, modes, w)
    return modes


@lean
def fix_edges(x: Any, c: Any, laws: Any, modes: Any, w: Any) -> None:
    """Sets the sign of every edge to that of the present state."""
    for j in range(c[FORCES]):
        if c[c[EDGE] + j] >= 0:
            sense = c[c[SENSE] + j]
            aux = beside(c, w, j)
            value = call_law(
                laws[c[c[EDGE] + j]], w[c[D] + sense], w[c[V] + sense], aux, x, c[PARAMETER] + PARAMETERS * j
            )
            modes[1 + j] = -1 if value < 0.0 else 1
