"""Right-hand side of the reduced model: ports, forces, set-valued friction, accelerations. Compiled."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from spacerobot.simulation.reduced.arrays import System
from spacerobot.support.jit import jit

APART, PRESSED, RELEASED = 0, 1, 2
"""Contact modes: surfaces apart; force carried; overlapping on paper but the contact force has ended."""

SLIP_MINUS, STICK, SLIP_PLUS = -1, 0, 1
TINY = 1e-300


class Work(NamedTuple):
    """Scratch arrays, and what the last evaluation found."""

    displacement: np.ndarray  # (P,)
    rate: np.ndarray  # (P,)
    bias: np.ndarray  # (P,) part of a port's acceleration that comes from velocities
    rows: np.ndarray  # (P, n)
    tau: np.ndarray  # (n,)
    raw: np.ndarray  # (F,) what the laws say
    force: np.ndarray  # (F,) what acts
    friction: np.ndarray  # (R,) friction forces, stuck or sliding
    matrix: np.ndarray  # (R, R)
    vector: np.ndarray  # (R,)
    stuck: np.ndarray  # (R,) int


def scratch(system: System) -> Work:
    """Scratch arrays of the right sizes."""
    ports, n = system.rows.shape
    forces, frictions = system.force_port.size, system.friction_port.size
    return Work(
        np.zeros(ports),
        np.zeros(ports),
        np.zeros(ports),
        system.rows.copy(),
        np.zeros(n),
        np.zeros(forces),
        np.zeros(forces),
        np.zeros(frictions),
        np.zeros((frictions, frictions)),
        np.zeros(frictions),
        np.zeros(frictions, dtype=np.int64),
    )


@jit
def kinematics(s: Any, y: Any, w: Any) -> None:
    """Displacements and rates of all ports at state y = (q, v)."""
    n = s.inverse_mass.size
    yaw = s.special[2]
    for p in range(s.rows.shape[0]):
        d = 0.0
        v = 0.0
        for i in range(n):
            r = s.rows[p, i]
            d += r * y[i]
            v += r * y[n + i]
        w.displacement[p] = d
        w.rate[p] = v
    if s.special[0] >= 0 and yaw >= 0:
        a, b = s.geometry[0], s.geometry[1]
        sine, cosine = np.sin(y[yaw]), np.cos(y[yaw])
        across = a * sine + b * cosine
        along = a * cosine - b * sine
        spin = y[n + yaw]
        press, slide = s.special[0], s.special[1]
        w.displacement[press] += a * (cosine - 1.0) - b * sine
        w.rate[press] -= across * spin
        w.rows[press, yaw] = -across
        w.bias[press] = -along * spin * spin
        w.displacement[slide] += a * sine + b * (cosine - 1.0)
        w.rate[slide] += along * spin
        w.rows[slide, yaw] = along
        w.bias[slide] = -across * spin * spin


@jit
def drive(s: Any, t: float, input_time: Any, input_value: Any, w: Any) -> None:
    """Adds the recorded drives, interpolated linearly; outside the record the nearest sample holds."""
    if s.input_port.size == 0:
        return
    last = input_time.size - 1
    k = np.searchsorted(input_time, t, side="right") - 1
    if k < 0:
        k, blend = 0, 0.0
    elif k >= last:
        k, blend = last, 0.0
    else:
        blend = (t - input_time[k]) / (input_time[k + 1] - input_time[k])
    for u in range(s.input_port.size):
        value = input_value[u, k]
        if blend > 0.0:
            value += blend * (input_value[u, k + 1] - value)
        p = s.input_port[u]
        for i in range(w.tau.size):
            w.tau[i] += w.rows[p, i] * s.input_gain[u] * value


@jit
def level(s: Any, laws: Any, r: int, v: float, normal: float) -> float:
    """Largest magnitude of friction r while sliding at rate v (its sign is the direction)."""
    load = normal if s.friction_normal[r] == 1 else 1.0
    return laws[s.friction_law[r]](v, load, 0.0, s.friction_parameters[r])


@jit
def evaluate(
    s: Any, laws: Any, t: float, y: Any, modes: Any, input_time: Any, input_value: Any, w: Any, out: Any
) -> None:
    """out = dy/dt; `w` keeps the forces. modes = (contact, edge signs (F), frictions (R))."""
    n = s.inverse_mass.size
    kinematics(s, y, w)
    for i in range(n):
        w.tau[i] = s.constant[i]
    normal = 0.0
    for j in range(s.force_port.size):
        sense = s.force_sense[j]
        aux = w.rate[s.force_aux[j]] if s.force_aux[j] >= 0 else 0.0
        f = laws[s.force_law[j]](w.displacement[sense], w.rate[sense], aux, s.parameters[j])
        w.raw[j] = f
        if j == s.special[3]:
            if modes[0] != PRESSED:
                f = 0.0
            normal = max(0.0, -f)
        w.force[j] = f
        p = s.force_port[j]
        for i in range(n):
            w.tau[i] += w.rows[p, i] * f
    drive(s, t, input_time, input_value, w)
    base = 1 + s.force_port.size
    stuck = 0
    for r in range(s.friction_port.size):
        m = modes[base + r]
        p = s.friction_port[r]
        if m == STICK:
            w.stuck[stuck] = r
            stuck += 1
            continue
        speed = m * max(m * w.rate[p], TINY)
        f = -m * level(s, laws, r, speed, normal)
        w.friction[r] = f
        for i in range(n):
            w.tau[i] += w.rows[p, i] * f
    if stuck > 0:
        _stick(s, stuck, w)
    for i in range(n):
        out[i] = y[n + i]
        out[n + i] = w.tau[i] * s.inverse_mass[i]


@jit
def _stick(s: Any, stuck: int, w: Any) -> None:
    """Forces that keep the stuck ports from accelerating: J M^-1 J^T f = -(J M^-1 tau + bias)."""
    n = s.inverse_mass.size
    for a in range(stuck):
        pa = s.friction_port[w.stuck[a]]
        total = w.bias[pa]
        for i in range(n):
            total += w.rows[pa, i] * s.inverse_mass[i] * w.tau[i]
        w.vector[a] = -total
        for b in range(stuck):
            pb = s.friction_port[w.stuck[b]]
            coupling = 0.0
            for i in range(n):
                coupling += w.rows[pa, i] * s.inverse_mass[i] * w.rows[pb, i]
            w.matrix[a, b] = coupling
    for a in range(stuck):  # elimination without pivoting: the matrix is symmetric positive semidefinite
        pivot = w.matrix[a, a]
        if pivot <= 1e-14:
            continue
        for b in range(a + 1, stuck):
            ratio = w.matrix[b, a] / pivot
            for c in range(a, stuck):
                w.matrix[b, c] -= ratio * w.matrix[a, c]
            w.vector[b] -= ratio * w.vector[a]
    for k in range(stuck):
        a = stuck - 1 - k
        pivot = w.matrix[a, a]
        value = w.vector[a]
        for b in range(a + 1, stuck):
            value -= w.matrix[a, b] * w.vector[b]
        # a second friction at the same port finds a zero pivot and carries nothing; the first carries all
        w.vector[a] = value / pivot if pivot > 1e-14 else 0.0
    for a in range(stuck):
        r = w.stuck[a]
        f = w.vector[a]
        w.friction[r] = f
        p = s.friction_port[r]
        for i in range(n):
            w.tau[i] += w.rows[p, i] * f


@jit
def guards(s: Any, laws: Any, modes: Any, w: Any, out: Any) -> None:
    """One value per mode, positive while the mode holds; call after `evaluate`. Shape (1 + F + R,)."""
    forces = s.force_port.size
    normal = 0.0
    if s.special[0] >= 0:
        d = w.displacement[s.special[0]]
        push = -w.raw[s.special[3]]
        normal = max(0.0, -w.force[s.special[3]])
        if modes[0] == APART:
            out[0] = -d
        elif modes[0] == PRESSED:
            out[0] = d if s.contact[1] > 0.5 else push + s.contact[0]
        else:
            out[0] = min(d, -push)
    else:
        out[0] = 1.0
    for j in range(forces):
        e = s.force_edge[j]
        if e < 0:
            out[1 + j] = 1.0
            continue
        sense = s.force_sense[j]
        aux = w.rate[s.force_aux[j]] if s.force_aux[j] >= 0 else 0.0
        value = laws[e](w.displacement[sense], w.rate[sense], aux, s.parameters[j])
        out[1 + j] = modes[1 + j] * value
    base = 1 + forces
    for r in range(s.friction_port.size):
        m = modes[base + r]
        if m == STICK:
            f = w.friction[r]
            limit = level(s, laws, r, -TINY if f > 0.0 else TINY, normal)
            out[base + r] = limit * (1.0 + 1e-12) + 1e-300 - abs(f)
        else:
            out[base + r] = m * w.rate[s.friction_port[r]]
