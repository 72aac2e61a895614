"""Right-hand side of the reduced model: ports, forces, set-valued friction, accelerations. Compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.effects.kernel import PARAMETERS
from spacerobot.effects.laws import contact_force
from spacerobot.simulation.reduced.arrays import (
    AUX,
    BIAS,
    CONSTANT,
    CONTACT_FORCE,
    EDGE,
    FORCE,
    FORCES,
    FRICTION,
    FRICTION_LAW,
    FRICTION_NORMAL,
    FRICTION_PARAMETER,
    FRICTION_PORT,
    FRICTIONS,
    GAIN,
    GEOMETRY,
    INPUT_PORT,
    INPUTS,
    LAW,
    MASS,
    MATRIX,
    NATIVE_CONTACT,
    NATIVE_DAMPER,
    NATIVE_SPRING,
    PARAMETER,
    PORT,
    PORTS,
    PRESS,
    RAW,
    ROWS,
    SENSE,
    SLIDE,
    STUCK,
    TAU,
    VECTOR,
    W_ROWS,
    YAW,
    D,
    N,
    V,
)
from spacerobot.support.jit import inlined, jit

native_contact = jit(contact_force)

APART, PRESSED, RELEASED = 0, 1, 2
"""Contact modes: surfaces apart; force carried; overlapping on paper but the contact force has ended."""

SLIP_MINUS, STICK, SLIP_PLUS = -1, 0, 1
TINY = 1e-300


@jit
def kinematics(x: Any, c: Any, y: Any, w: Any) -> None:
    """Displacements and rates of all ports at state y = (q, v)."""
    n = c[N]
    yaw = c[YAW]
    for p in range(c[PORTS]):
        d = 0.0
        v = 0.0
        for i in range(n):
            r = x[c[ROWS] + p * n + i]
            d += r * y[i]
            v += r * y[n + i]
        w[c[D] + p] = d
        w[c[V] + p] = v
    if c[PRESS] >= 0 and yaw >= 0:
        a, b = x[c[GEOMETRY] + 0], x[c[GEOMETRY] + 1]
        sine, cosine = np.sin(y[yaw]), np.cos(y[yaw])
        across = a * sine + b * cosine
        along = a * cosine - b * sine
        spin = y[n + yaw]
        press, slide = c[PRESS], c[SLIDE]
        w[c[D] + press] += a * (cosine - 1.0) - b * sine
        w[c[V] + press] -= across * spin
        w[c[W_ROWS] + press * n + yaw] = -across
        w[c[BIAS] + press] = -along * spin * spin
        w[c[D] + slide] += a * sine + b * (cosine - 1.0)
        w[c[V] + slide] += along * spin
        w[c[W_ROWS] + slide * n + yaw] = along
        w[c[BIAS] + slide] = -across * spin * spin


@jit
def drive(x: Any, c: Any, t: float, u: Any, w: Any) -> None:
    """Adds the recorded drives, interpolated linearly; outside the record the nearest sample holds."""
    if c[INPUTS] == 0:
        return
    n = c[N]
    last = u.shape[1] - 1
    k = int(np.searchsorted(u[0], t, side="right")) - 1
    if k < 0:
        k, blend = 0, 0.0
    elif k >= last:
        k, blend = last, 0.0
    else:
        blend = (t - u[0, k]) / (u[0, k + 1] - u[0, k])
    for j in range(c[INPUTS]):
        value = u[1 + j, k]
        if blend > 0.0:
            value += blend * (u[1 + j, k + 1] - value)
        p = c[c[INPUT_PORT] + j]
        for i in range(c[N]):
            w[c[TAU] + i] += w[c[W_ROWS] + p * n + i] * x[c[GAIN] + j] * value


@jit
def level(x: Any, c: Any, laws: Any, r: int, v: float, normal: float) -> float:
    """Largest magnitude of friction r while sliding at rate v (its sign is the direction)."""
    load = normal if c[c[FRICTION_NORMAL] + r] == 1 else 1.0
    return laws[c[c[FRICTION_LAW] + r]](
        v, load, 0.0, x[c[FRICTION_PARAMETER] + PARAMETERS * r : c[FRICTION_PARAMETER] + PARAMETERS * (r + 1)]
    )


@inlined
def act(x: Any, c: Any, laws: Any, t: float, modes: Any, u: Any, w: Any) -> int:
    """Adds what acts at the ports to TAU, from their displacements and rates; returns how many frictions stick.

    Fills RAW, FORCE, FRICTION (of the sliding) and STUCK (which are not). modes = (contact, edge signs (F),
    frictions (R)).
    """
    n = c[N]
    normal = 0.0
    for j in range(c[FORCES]):
        sense = c[c[SENSE] + j]
        aux = w[c[V] + c[c[AUX] + j]] if c[c[AUX] + j] >= 0 else 0.0
        law = c[c[LAW] + j]
        d, v = w[c[D] + sense], w[c[V] + sense]
        if law == NATIVE_SPRING:
            f = -x[c[PARAMETER] + PARAMETERS * j] * d
        elif law == NATIVE_DAMPER:
            f = -x[c[PARAMETER] + PARAMETERS * j] * v
        elif law == NATIVE_CONTACT:
            f = native_contact(d, v, aux, x[c[PARAMETER] + PARAMETERS * j : c[PARAMETER] + PARAMETERS * (j + 1)])
        else:
            f = laws[law](d, v, aux, x[c[PARAMETER] + PARAMETERS * j : c[PARAMETER] + PARAMETERS * (j + 1)])
        w[c[RAW] + j] = f
        if j == c[CONTACT_FORCE]:
            if modes[0] != PRESSED:
                f = 0.0
            normal = max(0.0, -f)
        w[c[FORCE] + j] = f
        p = c[c[PORT] + j]
        for i in range(n):
            w[c[TAU] + i] += w[c[W_ROWS] + p * n + i] * f
    drive(x, c, t, u, w)
    base = 1 + c[FORCES]
    stuck = 0
    for r in range(c[FRICTIONS]):
        m = modes[base + r]
        p = c[c[FRICTION_PORT] + r]
        if m == STICK:
            w[c[STUCK] + stuck] = r
            stuck += 1
            continue
        speed = m * max(m * w[c[V] + p], TINY)
        f = -m * level(x, c, laws, r, speed, normal)
        w[c[FRICTION] + r] = f
        for i in range(n):
            w[c[TAU] + i] += w[c[W_ROWS] + p * n + i] * f
    return stuck


@jit
def evaluate(x: Any, c: Any, laws: Any, t: float, y: Any, modes: Any, u: Any, w: Any, out: Any) -> None:
    """out = dy/dt; `w` keeps the forces. modes = (contact, edge signs (F), frictions (R))."""
    n = c[N]
    kinematics(x, c, y, w)
    for i in range(n):
        w[c[TAU] + i] = x[c[CONSTANT] + i]
    stuck = act(x, c, laws, t, modes, u, w)
    if stuck > 0:
        _stick(x, c, stuck, w)
    for i in range(n):
        out[i] = y[n + i]
        out[n + i] = w[c[TAU] + i] * x[c[MASS] + i]


@jit
def _stick(x: Any, c: Any, stuck: int, w: Any) -> None:
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


@jit
def guards(x: Any, c: Any, laws: Any, modes: Any, w: Any, out: Any) -> None:
    """One value per mode, positive while the mode holds; call after `evaluate`. Shape (1 + F + R,)."""
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
        aux = w[c[V] + c[c[AUX] + j]] if c[c[AUX] + j] >= 0 else 0.0
        value = laws[e](
            w[c[D] + sense],
            w[c[V] + sense],
            aux,
            x[c[PARAMETER] + PARAMETERS * j : c[PARAMETER] + PARAMETERS * (j + 1)],
        )
        out[1 + j] = modes[1 + j] * value
    base = 1 + forces
    for r in range(c[FRICTIONS]):
        m = modes[base + r]
        if m == STICK:
            f = w[c[FRICTION] + r]
            limit = level(x, c, laws, r, -TINY if f > 0.0 else TINY, normal)
            out[base + r] = limit * (1.0 + 1e-12) + 1e-300 - abs(f)
        else:
            out[base + r] = m * w[c[V] + c[c[FRICTION_PORT] + r]]
