"""A step for stiff machines: Radau IIA collocation, its equations solved through the slopes of the forces at the ports.

Servos, wrist and contact make a machine stiff through few ports: of all forces f_j(d, v) at ports with rows W the
slopes at the start of a step are taken, and what they feed back into the accelerations at the nodes is solved for
exactly, in as many unknowns as there are ports. What is left (laws that bend, gyroscopic forces, a pose that moves)
is smooth, and a few passes settle it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from spacerobot.simulation.multibody.kernel import configuration_rate, load, solve
from spacerobot.simulation.multibody.layout import SPLIT, layout_inside, scratch_inside
from spacerobot.simulation.multibody.machine import rate_at, row_of
from spacerobot.simulation.multibody.radau import DEFECT, FIT, GAMMA, INTO, LAGRANGE, NODES, OUT, ROOTS, A, C
from spacerobot.simulation.multibody.turning import far_astray, place, slides, turning
from spacerobot.simulation.reduced.arrays import AUX, FORCES, FRICTIONS, PORT, SENSE, W_ROWS, D, V
from spacerobot.simulation.reduced.forces import STICK, say
from spacerobot.support.jit import lean

PASSES = 8
"""Most passes of a step; one that needs more is taken shorter."""

CLOSE = 0.02
"""Share of the tolerated error to which the passes are carried (Hairer and Wanner II, section IV.8: 0.1 to 0.01)."""


class Room(NamedTuple):
    """Work arrays. s nodes, N states, n velocities, P ports, E eigenvalues."""

    f: np.ndarray  # (s, N) slopes at the nodes
    z: np.ndarray  # (s, N) changes of state at the nodes
    guess: np.ndarray  # (s, N)
    residual: np.ndarray  # (s, n)
    ports: np.ndarray  # (P,) int: those through which forces feed back
    rows: np.ndarray  # (P, n)
    give: np.ndarray  # (P, n) M^-1 rows^T
    stuck: np.ndarray  # (R, n)
    spring: np.ndarray  # (P, P) minus the slope of a port's force by displacement
    damper: np.ndarray  # (P, P) by rate
    stiff: np.ndarray  # (P, P) what they feed back: rows give^T spring
    slow: np.ndarray  # (P, P)
    inverse: np.ndarray  # (E, P, P) complex
    matrix: np.ndarray  # (P, P) complex
    right: np.ndarray  # (E, P) complex
    answer: np.ndarray  # (E, P) complex
    push: np.ndarray  # (s, P)
    spread: np.ndarray  # (2, N)
    state: np.ndarray  # (2,) int: ports in use, and whether `f` holds the slopes of the step before
    before: np.ndarray  # (1,) its length [s]


def room_for(size: int, nv: int, ports: int, frictions: int) -> Room:
    """Fresh arrays."""
    s, e, p = NODES, ROOTS.size, ports
    z = np.zeros
    return Room(
        z((s, size)), z((s, size)), z((s, size)), z((s, nv)), z(p, np.int64), z((p, nv)), z((p, nv)),
        z((max(frictions, 1), nv)), z((p, p)), z((p, p)), z((p, p)), z((p, p)), z((e, p, p), complex),
        z((p, p), complex), z((e, p), complex), z((e, p), complex), z((s, p)), z((2, size)), z(2, np.int64), z(1),
    )  # fmt: skip


@lean
def _slope(m: Any, j: int, at: int, probe: float) -> float:
    """Change of force j per change of the displacement or rate that stands there in the work array."""
    here = m.w[at]
    before = say(m.x, m.c, m.laws, m.modes, m.w, j)
    m.w[at] = here + probe
    change = say(m.x, m.c, m.laws, m.modes, m.w, j) - before
    m.w[at] = here
    say(m.x, m.c, m.laws, m.modes, m.w, j)
    return change / probe


@lean
def linearise(m: Any, scale: Any, o: Any) -> float:
    """Slopes of all forces at the state last evaluated, and what they feed back; returns a bound of its fastest rate.

    The rate [1/s] is that of the sum over all ports, whose traces are at least the largest eigenvalues.
    """
    c, w, nq, nv = m.c, m.w, m.q.size, m.v.size
    o.state[0] = 0
    for j in range(c[FORCES]):
        port, sense, aux = c[c[PORT] + j], c[c[SENSE] + j], c[c[AUX] + j]
        d, v = c[D] + sense, c[V] + sense
        k = -_slope(m, j, d, max(scale[0], 1e-6 * abs(w[d])))
        r = -_slope(m, j, v, max(scale[nq], 1e-6 * abs(w[v])))
        x = 0.0 if aux < 0 else -_slope(m, j, c[V] + aux, max(scale[nq], 1e-6 * abs(w[c[V] + aux])))
        if k == 0.0 and r == 0.0 and x == 0.0:
            continue
        a, b = place(o, port), place(o, sense)
        o.spring[a, b] += k
        o.damper[a, b] += r
        if x != 0.0:
            b = place(o, aux)
            o.damper[a, b] += x
    for r in range(c[FRICTIONS]):
        if slides(m, r):
            turning(m, r, o)
    split, scratch, held = m.ints[SPLIT], scratch_inside(m.ints, m.work), 0
    for r in range(c[FRICTIONS]):
        if m.modes[1 + c[FORCES] + r] != STICK:
            continue
        row, s = row_of(m, r), o.stuck[held]
        for i in range(nv):
            s[i] = w[row + i]
        solve(scratch.factor, split, s)
        _apart(o, held, w, row, s)
        square = 0.0
        for i in range(nv):
            square += w[row + i] * s[i]
        if square > 0.0:
            for i in range(nv):
                s[i] /= np.sqrt(square)
            held += 1
    p = o.state[0]
    for a in range(p):
        row, g = c[W_ROWS] + o.ports[a] * nv, o.give[a]
        for i in range(nv):
            g[i] = o.rows[a, i] = w[row + i]
        solve(scratch.factor, split, g)
        _apart(o, held, w, row, g)
    fast, hard = 0.0, 0.0
    for a in range(p):
        for b in range(p):
            o.stiff[a, b] = o.slow[a, b] = 0.0
        for e in range(p):
            coupling = 0.0
            for i in range(nv):
                coupling += o.rows[a, i] * o.give[e, i]
            for b in range(p):
                o.stiff[a, b] += coupling * o.spring[e, b]
                o.slow[a, b] += coupling * o.damper[e, b]
        hard += o.stiff[a, a]
        fast += o.slow[a, a]
    return float(abs(fast) + np.sqrt(abs(hard)))


@lean
def _apart(o: Any, held: int, w: Any, row: int, g: Any) -> None:
    """g = M^-1 (row) without what the ports that stick take up; `stuck` is orthonormal in M."""
    for e in range(held):
        share = 0.0
        for i in range(g.size):
            share += w[row + i] * o.stuck[e, i]
        for i in range(g.size):
            g[i] -= share * o.stuck[e, i]


@lean
def _invert(a: Any, out: Any, n: int) -> None:
    """out = a^-1 by Gauss and Jordan with row exchange; a is overwritten."""
    for i in range(n):
        for j in range(n):
            out[i, j] = 1.0 if i == j else 0.0
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[best, k]):
                best = i
        if best != k:
            for j in range(n):
                a[k, j], a[best, j] = a[best, j], a[k, j]
                out[k, j], out[best, j] = out[best, j], out[k, j]
        pivot = 1.0 / a[k, k]
        for j in range(n):
            a[k, j] *= pivot
            out[k, j] *= pivot
        for i in range(n):
            share = a[i, k]
            if i != k and share != 0.0:
                for j in range(n):
                    a[i, j] -= share * a[k, j]
                    out[i, j] -= share * out[k, j]


@lean
def _prepare(o: Any, h: float) -> None:
    p = o.state[0]
    for e in range(ROOTS.size):
        x = h * ROOTS[e]
        for a in range(p):
            for b in range(p):
                o.matrix[a, b] = x * x * o.stiff[a, b] + x * o.slow[a, b] + (1.0 if a == b else 0.0)
        _invert(o.matrix, o.inverse[e], p)


@lean
def _correct(o: Any, h: float) -> None:
    """residual = change of the accelerations at the nodes that takes it away."""
    p, nv = o.state[0], o.residual.shape[1]
    for e in range(ROOTS.size):
        x = h * ROOTS[e]
        for a in range(p):
            o.right[e, a] = 0.0
        for j in range(NODES):
            for a in range(p):
                if e == 0:
                    o.push[j, a] = 0.0
                    for i in range(nv):
                        o.push[j, a] += o.rows[a, i] * o.residual[j, i]
                o.right[e, a] += INTO[e, j] * o.push[j, a]
        for a in range(p):
            o.answer[e, a] = 0.0
            for b in range(p):
                o.answer[e, a] += o.inverse[e, a, b] * o.right[e, b]
        for a in range(p):
            o.right[e, a] = 0.0
            for b in range(p):
                o.right[e, a] += (x * x * o.spring[a, b] + x * o.damper[a, b]) * o.answer[e, b]
    for j in range(NODES):
        for a in range(p):
            push = 0.0
            for e in range(ROOTS.size):
                push += (OUT[j, e] * o.right[e, a]).real
            for i in range(nv):
                o.residual[j, i] -= push * o.give[a, i]


@lean
def _foretell(o: Any, k: Any, h: float) -> None:
    """Slopes at the nodes: the polynomial of the step before carried on; without one, the slope at the start."""
    size = k.size
    if o.state[1] == 0:
        for j in range(NODES):
            for i in range(size):
                o.guess[j, i] = k[i]
    else:
        for j in range(NODES):
            x, total = 1.0 + C[j] * h / o.before[0], 1.0
            for a in range(NODES):
                total *= x - C[a]
            for i in range(size):
                o.guess[j, i] = 0.0
            for a in range(NODES):
                share = total * LAGRANGE[a] / (x - C[a])
                for i in range(size):
                    o.guess[j, i] += share * o.f[a, i]
    for j in range(NODES):
        for i in range(size):
            o.f[j, i] = o.guess[j, i]


@lean
def collocate(m: Any, t: float, y: Any, h: float, k: Any, scale: Any, o: Any, temp: Any, new: Any) -> float:
    """One step of length h [s] from (t, y), whose slope is k; the end is left in `new`, the slopes in the room.

    Returns:
        Error of the step over its tolerance; not a number if the passes did not settle.
    """
    nq, nv, size = m.q.size, m.v.size, y.size
    joints = layout_inside(m.ints, m.floats).joints
    _prepare(o, h)
    _foretell(o, k, h)
    o.state[1] = 0
    last, settled = 1e300, False
    for turn in range(PASSES):
        _changes(o, h, 0, size)
        astray = 0.0
        for j in range(NODES):
            for i in range(size):
                temp[i] = y[i] + o.z[j, i]
            rate_at(m, t + C[j] * h, temp, new)
            for i in range(nv):
                o.residual[j, i] = new[nq + i] - o.f[j, nq + i]
            astray = max(astray, far_astray(m, o, h, j) / scale[nq])
            for i in range(size):
                if i < nq or i >= nq + nv:
                    o.f[j, i] = new[i]
        _correct(o, h)
        for j in range(NODES):
            for i in range(nv):
                o.f[j, nq + i] += o.residual[j, i]
        change = astray
        for j in range(NODES):
            for i in range(nv):
                dv = 0.0
                for e in range(NODES):
                    dv += A[j, e] * o.residual[e, i]
                dv *= h
                change = max(change, abs(dv) / scale[nq + i], abs(dv * C[j] * h) / scale[0])
        if not change < 1e100:
            return np.nan
        _changes(o, h, nq, nq + nv)
        for j in range(NODES):  # rates of the configuration at the corrected velocities
            for i in range(size):
                temp[i] = y[i] + o.z[j, i]
            load(temp, joints, m.q, m.v)
            configuration_rate(m.q, m.v, joints, o.f[j])
        ratio = change / last
        last = change
        if change <= CLOSE or (turn > 0 and ratio < 1.0 and change * ratio / (1.0 - ratio) <= CLOSE):
            settled = True
            break
        if turn > 1 and ratio > 1.0:
            break
    _changes(o, h, 0, size)
    for i in range(size):
        new[i] = y[i] + o.z[NODES - 1, i]
    if not settled:
        return np.nan
    return _error(m, y, h, k, scale, o)


@lean
def _changes(o: Any, h: float, first: int, last: int) -> None:
    for j in range(NODES):
        for i in range(first, last):
            o.z[j, i] = 0.0
        for e in range(NODES):
            a = h * A[j, e]
            for i in range(first, last):
                o.z[j, i] += a * o.f[e, i]


@lean
def _error(m: Any, y: Any, h: float, k: Any, scale: Any, o: Any) -> float:
    """Hairer and Wanner II, eq. IV.8.20: what a stiff force would blow up is filtered as the step itself does it."""
    nq, nv, size, p = m.q.size, m.v.size, y.size, o.state[0]
    moved, raw, x = o.spread[0], o.spread[1], h * GAMMA
    for i in range(nv):
        moved[i] = GAMMA * y[nq + i]
        for j in range(NODES):
            moved[i] += DEFECT[j] * (y[nq + i] + o.z[j, nq + i])
        moved[i] *= h
    for i in range(nq, size):
        raw[i] = GAMMA * k[i]
        for j in range(NODES):
            raw[i] += DEFECT[j] * o.f[j, i]
        raw[i] *= h
    for a in range(p):
        speed = 0.0
        for i in range(nv):
            speed += o.rows[a, i] * raw[nq + i]
        o.push[0, a] = 0.0
        for i in range(nv):
            o.push[0, a] += o.rows[a, i] * moved[i]
        o.push[1, a] = speed
    for a in range(p):
        for b in range(p):
            o.push[1, a] -= x * o.stiff[a, b] * o.push[0, b]
    for a in range(p):
        o.push[2, a] = 0.0
        for b in range(p):
            o.push[2, a] += o.inverse[0, a, b].real * o.push[1, b]
    for a in range(p):
        force = 0.0
        for b in range(p):
            force += x * (o.spring[a, b] * (o.push[0, b] + x * o.push[2, b]) + o.damper[a, b] * o.push[2, b])
        for i in range(nv):
            raw[nq + i] -= force * o.give[a, i]
    total = 0.0
    for i in range(nv):
        total += (raw[nq + i] / scale[nq + i]) ** 2 + ((moved[i] + x * raw[nq + i]) / scale[0]) ** 2
    for i in range(nq + nv, size):
        total += (raw[i] / scale[i]) ** 2
    return float(np.sqrt(total))


@lean
def accepted(o: Any, h: float) -> None:
    """The next step's slopes are foretold from the one just taken, of length h [s]; from none if 0."""
    o.state[1], o.before[0] = h > 0.0, h


@lean
def stretch(o: Any, change: float) -> None:
    """Lengthens the step just taken by little [s], along its slopes."""
    for j in range(NODES):
        for i in range(o.f.shape[1]):
            o.z[j, i] += C[j] * change * o.f[j, i]


@lean
def collocated(o: Any, f: Any) -> None:
    """The collocation polynomial of the step just taken as the record's interpolant, f shape (POWERS, N)."""
    for p in range(f.shape[0]):
        for i in range(f.shape[1]):
            f[p, i] = 0.0
            for j in range(NODES):
                f[p, i] += FIT[p, j] * o.z[j, i]
