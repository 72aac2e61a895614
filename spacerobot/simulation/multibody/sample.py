"""What is read from a record at given times: states, forces, momenta, energies. Compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.simulation.multibody.dop853 import POWERS
from spacerobot.simulation.multibody.kernel import ALL
from spacerobot.simulation.multibody.layout import BODIES, RISE, bodies_of, scratch_inside, tree_of
from spacerobot.simulation.multibody.machine import NEEDS, guards_at, rate_at, row_of, size_of
from spacerobot.simulation.multibody.stepper import interpolate
from spacerobot.simulation.reduced.arrays import (
    FORCE,
    FORCES,
    FRICTION,
    FRICTIONS,
    HEADING,
    PRESS,
    REMEMBERED,
    SLIDE,
    STATES,
    TAU,
    D,
    V,
)
from spacerobot.simulation.reduced.forces import STICK
from spacerobot.support.jit import jit, lean


def widths(nf: int, nq: int, nv: int, forces: int, frictions: int, states: int, inputs: int) -> dict[str, int]:
    """What a row of `read` holds, in order, and how many numbers of each."""
    return {
        "feature": 2 * nf,
        "acceleration": nf,
        "force": forces,
        "friction": frictions,
        "remembered": states,
        "generalized": nv,
        "contact": 6,
        "configuration": nq,
        "rates": nv,
        "place": 3 * (BODIES - 1),
        "kinetic": 1,
        "potential": 1,
        "momentum": 6,
        "work": forces + frictions + states + inputs,
        "memory": states,
        "modes": 1 + forces + frictions + states,
    }


@lean
def _state(m: Any, row: Any, t: float, y: Any) -> None:
    """Ambient state and modes at a time in the step that a row of the record holds."""
    size, modes, h = y.size, m.modes.size, row[1]
    theta = min(max((t - row[0]) / h, 0.0), 1.0) if h > 0.0 else 0.0
    at = 2 + size + POWERS * size
    interpolate(row[2 : 2 + size], row[2 + size : at].reshape((POWERS, size)), theta, y)
    for i in range(modes):
        m.modes[i] = int(row[at + i])
    for r in range(m.c[FRICTIONS]):
        m.w[m.c[HEADING] + r] = row[at + modes + r]


@lean
def _moving(m: Any, out: Any) -> None:
    """Kinetic and potential energy, momentum and angular momentum about the world's origin, eight numbers.

    A composite body's momentum is its inertia times the velocity of its joint's own motion; over all joints they sum
    up to that of everything (Featherstone 2008, section 6.2).
    """
    tree, bodies = tree_of(m.ints, m.floats), bodies_of(m.ints, m.work)
    nv, g = m.v.size, tree.gravity
    for i in range(8):
        out[i] = 0.0
    for i in range(nv):
        for j in range(nv):
            out[0] += 0.5 * m.v[i] * bodies.inertia[i, j] * m.v[j]
    for i in range(tree.mass.size):
        c, p = bodies.composite[i], bodies.point[i]
        mass, hx, hy, hz = c[0], c[1], c[2], c[3]
        if tree.joint[i, 0] < 0:
            for k in range(3):
                out[1] -= g[k] * (c[1 + k] + mass * p[k])
        first = tree.joint[i, 3]
        last = nv if i + 1 == tree.mass.size else tree.joint[i + 1, 3]
        for d in range(first, last):
            s, v = bodies.motion[d], m.v[d]
            x, y, z, a, b, e = s[0], s[1], s[2], s[3], s[4], s[5]
            fx, fy, fz = mass * x + b * hz - e * hy, mass * y + e * hx - a * hz, mass * z + a * hy - b * hx
            nx = c[4] * a + c[5] * b + c[7] * e + hy * z - hz * y
            ny = c[5] * a + c[6] * b + c[8] * e + hz * x - hx * z
            nz = c[7] * a + c[8] * b + c[9] * e + hx * y - hy * x
            out[2] += v * fx
            out[3] += v * fy
            out[4] += v * fz
            out[5] += v * (nx + p[1] * fz - p[2] * fy)
            out[6] += v * (ny + p[2] * fx - p[0] * fz)
            out[7] += v * (nz + p[0] * fy - p[1] * fx)


@lean
def _read(m: Any, t: float, y: Any, rate: Any, o: Any) -> None:
    """Everything at the state y, into o."""
    nq, nv, c, w = m.q.size, m.v.size, m.c, m.w
    scratch = scratch_inside(m.ints, m.work)
    nf = scratch.row.shape[0]
    rate_at(m, t, y, rate)
    for f in range(nf):
        o[2 * f], o[2 * f + 1] = scratch.value[f, 0], scratch.value[f, 1]
        total = scratch.value[f, 2]
        for i in range(nv):
            total += scratch.row[f, i] * rate[nq + i]
        o[2 * nf + f] = total
    at = 3 * nf
    for j in range(c[FORCES]):
        o[at + j] = w[c[FORCE] + j]
    at += c[FORCES]
    for r in range(c[FRICTIONS]):
        o[at + r] = w[c[FRICTION] + r]
    at += c[FRICTIONS]
    for s in range(c[STATES]):
        o[at + s] = w[c[REMEMBERED] + s]
    at += c[STATES]
    for i in range(nv):
        o[at + i] = w[c[TAU] + i]
        for r in range(c[FRICTIONS]):
            if m.modes[1 + c[FORCES] + r] == STICK:  # what holds is not in TAU yet
                o[at + i] += w[c[FRICTION] + r] * w[row_of(m, r) + i]
    at += nv
    for k in range(3):
        p = c[PRESS] if k == 0 else c[SLIDE] if k == 1 else m.ints[RISE]
        o[at + 2 * k] = w[c[D] + p] if p >= 0 else 0.0
        o[at + 2 * k + 1] = w[c[V] + p] if p >= 0 else 0.0
    at += 6
    for i in range(nq):
        o[at + i] = m.q[i]
    at += nq
    for i in range(nv):
        o[at + i] = m.v[i]
    at += nv
    for b in range(1, BODIES):
        for i in range(3):
            o[at] = scratch.place[b, i]
            at += 1
    _moving(m, o[at : at + 8])
    at += 8
    for j in range(y.size - nq - nv):
        o[at + j] = y[nq + nv + j]
    at += y.size - nq - nv
    for i in range(m.modes.size):
        o[at + i] = m.modes[i]


@jit
def read(m: Any, rows: Any, index: Any, times: Any, out: Any) -> None:
    """Everything at `times`, one row of `out` each, as `widths` says; `index` is the step of each."""
    y, rate, before = np.empty(size_of(m)), np.empty(size_of(m)), m.settings[NEEDS]
    m.settings[NEEDS] = ALL
    for n in range(times.size):
        _state(m, rows[index[n]], times[n], y)
        _read(m, times[n], y, rate, out[n])
    m.settings[NEEDS] = before


@jit
def pushes(m: Any, rows: Any, index: Any, times: Any, out: Any) -> None:
    """Contact force, positive in compression, at `times`, shape (T,) [N]."""
    y, slope, g = np.empty(size_of(m)), np.empty(size_of(m)), np.empty(m.modes.size)
    for n in range(times.size):
        _state(m, rows[index[n]], times[n], y)
        guards_at(m, times[n], y, g, slope)
        out[n] = -m.w[m.c[FORCE]]


@jit
def displacements(rows: Any, size: int, index: Any, times: Any, at: int, out: Any) -> None:
    """One number of the ambient state at `times`, shape (T,)."""
    y, f = np.empty(1), np.empty((POWERS, 1))
    for n in range(times.size):
        row = rows[index[n]]
        theta = min(max((times[n] - row[0]) / row[1], 0.0), 1.0) if row[1] > 0.0 else 0.0
        y[0] = row[2 + at]
        for p in range(POWERS):
            f[p, 0] = row[2 + size * (1 + p) + at]
        interpolate(y, f, theta, out[n : n + 1])
