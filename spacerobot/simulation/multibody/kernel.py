"""The compiled half of the right-hand side: ports from Pinocchio's Jacobian, forces, sticking, accelerations.

Pinocchio gives, at (q, v): the joint-space inertia M, the bias forces h, and the joint Jacobian J in world axes,
whose linear rows are the velocity of the body point at the world's origin. Everything below is what remains, so
that one evaluation costs little more than Pinocchio itself.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.simulation.multibody.layout import Scratch, layout_inside, scratch_inside
from spacerobot.simulation.reduced.arrays import (
    BIAS,
    FORCE,
    FORCES,
    FRICTION,
    FRICTION_PORT,
    FRICTIONS,
    PORT,
    PRESS,
    SLIDE,
    STUCK,
    TAU,
    W_ROWS,
    D,
    V,
)
from spacerobot.simulation.reduced.forces import STICK, act
from spacerobot.support.jit import lean

STRAIGHT, CIRCLE, POINT, YAW = range(4)
"""Kinds of feature: a joint with one number; with cosine and sine; a frame's displacement; the target's heading."""

WORLD, HAND, TIP, BASE, TARGET = range(5)
"""Bodies that features and contact read."""

QUATERNION, PAIR, PLAIN = range(3)
"""Kinds of joint, by what their configuration is."""


@lean
def load(y: Any, joints: Any, q: Any, v: Any) -> None:
    """Configuration on its manifold and velocity from the ambient state."""
    nq, nv = q.size, v.size
    for i in range(nq):
        q[i] = y[i]
    for i in range(nv):
        v[i] = y[nq + i]
    for j in range(joints.shape[0]):
        first, count = joints[j, 1], 0
        if joints[j, 0] == QUATERNION:
            first, count = first + 3, 4
        elif joints[j, 0] == PAIR:
            count = 2
        if count:
            square = 0.0
            for i in range(first, first + count):
                square += q[i] * q[i]
            length = np.sqrt(square) if square > 0.0 else np.nan
            for i in range(first, first + count):
                q[i] /= length


@lean
def configuration_rate(q: Any, v: Any, joints: Any, out: Any) -> None:
    """dq/dt in ambient coordinates."""
    for j in range(joints.shape[0]):
        kind, a, b = joints[j, 0], joints[j, 1], joints[j, 2]
        if kind == PLAIN:
            out[a] = v[b]
        elif kind == PAIR:
            out[a], out[a + 1] = -q[a + 1] * v[b], q[a] * v[b]
        else:
            x, y, z, w = q[a + 3], q[a + 4], q[a + 5], q[a + 6]
            p, r, s = v[b], v[b + 1], v[b + 2]
            tx, ty, tz = 2.0 * (y * s - z * r), 2.0 * (z * p - x * s), 2.0 * (x * r - y * p)
            out[a] = p + w * tx + y * tz - z * ty
            out[a + 1] = r + w * ty + z * tx - x * tz
            out[a + 2] = s + w * tz + x * ty - y * tx
            p, r, s = 0.5 * v[b + 3], 0.5 * v[b + 4], 0.5 * v[b + 5]
            out[a + 3] = w * p + y * s - z * r
            out[a + 4] = w * r + z * p - x * s
            out[a + 5] = w * s + x * r - y * p
            out[a + 6] = -x * p - y * r - z * s


@lean
def _turned(rotation: Any, a: Any, out: Any) -> None:
    """out = rotation a."""
    for i in range(3):
        out[i] = rotation[i, 0] * a[0] + rotation[i, 1] * a[1] + rotation[i, 2] * a[2]


@lean
def _along(a: Any, b: Any) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@lean
def _row(jacobian: Any, mask: Any, n: Any, p: Any, sign: float, out: Any) -> None:
    """out += sign * velocity along n of the body point at p, per unit velocity."""
    m0 = p[1] * n[2] - p[2] * n[1]
    m1 = p[2] * n[0] - p[0] * n[2]
    m2 = p[0] * n[1] - p[1] * n[0]
    for i in range(out.size):
        if mask[i]:
            out[i] += sign * (
                n[0] * jacobian[0, i]
                + n[1] * jacobian[1, i]
                + n[2] * jacobian[2, i]
                + m0 * jacobian[3, i]
                + m1 * jacobian[4, i]
                + m2 * jacobian[5, i]
            )


@lean
def _drift(jacobian: Any, rate: Any, mask: Any, v: Any, p: Any, out: Any) -> None:
    """Angular velocity, velocity and bias acceleration of the body point at p: out shape (3, 3)."""
    for k in range(3):
        for i in range(3):
            out[k, i] = 0.0
    for k in range(3):
        drift, turn = 0.0, 0.0
        for i in range(v.size):
            if mask[i]:
                out[0, k] += jacobian[3 + k, i] * v[i]
                out[1, k] += jacobian[k, i] * v[i]
                drift += rate[k, i] * v[i]
                turn += rate[3 + k, i] * v[i]
        out[2, k] += drift
        out[2, (k + 1) % 3] -= turn * p[(k + 2) % 3]  # (angular bias) x p
        out[2, (k + 2) % 3] += turn * p[(k + 1) % 3]
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        out[1, k] += out[0, i] * p[j] - out[0, j] * p[i]
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        out[2, k] += out[0, i] * out[1, j] - out[0, j] * out[1, i]


@lean
def sense(
    c: Any,
    w: Any,
    ints: Any,
    floats: Any,
    work: Any,
    q: Any,
    v: Any,
    jacobian: Any,
    rate: Any,
    biased: bool,
    r_hand: Any,
    t_hand: Any,
    r_tip: Any,
    t_tip: Any,
    r_base: Any,
    t_base: Any,
    r_target: Any,
    t_target: Any,
) -> None:
    """Rows, displacements, rates and (where `biased`) bias accelerations of all ports, into `w`.

    `ints`, `floats` and `work` hold Layout and Scratch.
    """
    layout, scratch = layout_inside(ints, floats), scratch_inside(ints, work)
    nv = v.size
    row, value, place = scratch.row, scratch.value, scratch.place
    motion, other, vectors = scratch.motion[0], scratch.motion[1], scratch.vectors
    _turned(r_hand, layout.local[HAND], place[HAND])
    _turned(r_tip, layout.local[TIP], place[TIP])
    _turned(r_base, layout.local[BASE], place[BASE])
    touch, apart = vectors[0], vectors[1]
    _turned(r_target, layout.local[TARGET], touch)
    for i in range(3):
        place[HAND, i] += t_hand[i]
        place[TIP, i] += t_tip[i]
        place[BASE, i] += t_base[i]
        place[TARGET, i] = t_target[i]
        touch[i] += t_target[i]
        apart[i] = touch[i] - place[TIP, i]
    for f in range(row.shape[0]):
        kind, a, b = layout.feature[f, 0], layout.feature[f, 1], layout.feature[f, 2]
        for i in range(nv):
            row[f, i] = 0.0
        bias = 0.0
        if kind == STRAIGHT:
            d = q[a] - layout.reference[f]
            row[f, b] = 1.0
        elif kind == CIRCLE:
            d = np.arctan2(q[a + 1], q[a]) - layout.reference[f]
            d -= 2.0 * np.pi * np.round(d / (2.0 * np.pi))
            row[f, b] = 1.0
        elif kind == POINT:
            n = layout.axes[b]
            d = _along(n, place[a]) - layout.reference[f]
            _row(jacobian, layout.support[a], n, place[a], 1.0, row[f])
            if biased:
                _drift(jacobian, rate, layout.support[a], v, place[a], motion)
                bias = _along(n, motion[2])
        else:
            turned, up = vectors[2], layout.axes[2]
            _turned(r_target, layout.ahead, turned)
            d = np.arctan2(_along(layout.axes[1], turned), _along(layout.axes[0], turned))
            for i in range(nv):
                if layout.support[TARGET, i]:
                    row[f, i] = up[0] * jacobian[3, i] + up[1] * jacobian[4, i] + up[2] * jacobian[5, i]
                    if biased:
                        bias += (up[0] * rate[3, i] + up[1] * rate[4, i] + up[2] * rate[5, i]) * v[i]
        speed = 0.0
        for i in range(nv):
            speed += row[f, i] * v[i]
        value[f, 0], value[f, 1], value[f, 2] = d, speed, bias
    for p in range(layout.ports.shape[0]):
        d, speed, bias = 0.0, 0.0, 0.0
        at = c[W_ROWS] + p * nv
        for i in range(nv):
            w[at + i] = 0.0
        for f in range(row.shape[0]):
            share = layout.ports[p, f]
            if share != 0.0:
                d += share * value[f, 0]
                speed += share * value[f, 1]
                bias += share * value[f, 2]
                for i in range(nv):
                    w[at + i] += share * row[f, i]
        w[c[D] + p], w[c[V] + p], w[c[BIAS] + p] = d, speed, bias
    if c[PRESS] < 0:
        return
    relative = vectors[3]
    if biased:
        _drift(jacobian, rate, layout.support[TIP], v, touch, other)
        _drift(jacobian, rate, layout.support[TARGET], v, touch, motion)
        x, y, z = motion[1, 0] - other[1, 0], motion[1, 1] - other[1, 1], motion[1, 2] - other[1, 2]
        relative[0] = motion[2, 0] - other[2, 0] - 2.0 * (other[0, 1] * z - other[0, 2] * y)
        relative[1] = motion[2, 1] - other[2, 1] - 2.0 * (other[0, 2] * x - other[0, 0] * z)
        relative[2] = motion[2, 2] - other[2, 2] - 2.0 * (other[0, 0] * y - other[0, 1] * x)
    n = vectors[4]
    for k in range(3):
        p = c[PRESS] if k == 0 else c[SLIDE] if k == 1 else layout.rise
        if p < 0:
            continue
        _turned(r_tip, layout.tip_axes[k], n)
        out = w[c[W_ROWS] + p * nv : c[W_ROWS] + (p + 1) * nv]
        for i in range(nv):
            out[i] = 0.0
        # the face belongs to the tip, the point to the target; both feel the force at the point
        _row(jacobian, layout.support[TARGET], n, touch, 1.0, out)
        _row(jacobian, layout.support[TIP], n, touch, -1.0, out)
        speed = 0.0
        for i in range(nv):
            speed += out[i] * v[i]
        w[c[D] + p], w[c[V] + p] = _along(n, apart), speed
        w[c[BIAS] + p] = _along(n, relative) if biased else 0.0


@lean
def exert(x: Any, c: Any, laws: Any, t: float, modes: Any, u: Any, w: Any, count: int) -> int:
    """Forces at the ports from what `sense` found; returns how many frictions stick."""
    for i in range(count):
        w[c[TAU] + i] = 0.0
    return act(x, c, laws, t, modes, u, w, c[FORCES])


@lean
def _factorise(inertia: Any, first: int, last: int, factor: Any) -> None:
    for i in range(first, last):
        for j in range(first, i + 1):
            total = inertia[j, i]
            for k in range(first, j):
                total -= factor[i, k] * factor[j, k]
            if i == j:
                # a trial step that overshoots may leave no inertia: not a number, and the step is refused
                factor[i, i] = np.sqrt(total) if total > 0.0 else np.nan
            else:
                factor[i, j] = total / factor[j, j]


@lean
def _solve(factor: Any, first: int, last: int, b: Any) -> None:
    for i in range(first, last):
        total = b[i]
        for k in range(first, i):
            total -= factor[i, k] * b[k]
        b[i] = total / factor[i, i]
    for i in range(last - 1, first - 1, -1):
        total = b[i]
        for k in range(i + 1, last):
            total -= factor[k, i] * b[k]
        b[i] = total / factor[i, i]


@lean
def solve(factor: Any, split: int, b: Any) -> None:
    """b = M^-1 b; robot and target are two blocks."""
    _solve(factor, 0, split, b)
    _solve(factor, split, b.size, b)


@lean
def accelerate(
    x: Any,
    c: Any,
    laws: Any,
    t: float,
    modes: Any,
    u: Any,
    w: Any,
    ints: Any,
    floats: Any,
    work: Any,
    q: Any,
    v: Any,
    inertia: Any,
    bias: Any,
    out: Any,
) -> None:
    """out = d/dt (configuration, velocity, work of every force and friction); call after `sense`."""
    layout, scratch = layout_inside(ints, floats), scratch_inside(ints, work)
    nq, nv = q.size, v.size
    stuck = exert(x, c, laws, t, modes, u, w, nv)
    split = layout.split
    _factorise(inertia, 0, split, scratch.factor)
    _factorise(inertia, split, nv, scratch.factor)
    free = scratch.free
    for i in range(nv):
        free[i] = w[c[TAU] + i] - bias[i]
    solve(scratch.factor, split, free)
    if stuck:
        hold(c, w, stuck, split, scratch)
    configuration_rate(q, v, layout.joints, out)
    for i in range(nv):
        out[nq + i] = free[i]
    at = nq + nv
    for j in range(c[FORCES]):
        out[at + j] = w[c[FORCE] + j] * w[c[V] + c[c[PORT] + j]]
    at += c[FORCES]
    for r in range(c[FRICTIONS]):
        sticks = modes[1 + c[FORCES] + r] == STICK
        out[at + r] = 0.0 if sticks else w[c[FRICTION] + r] * w[c[V] + c[c[FRICTION_PORT] + r]]


@lean
def hold(c: Any, w: Any, stuck: int, split: int, scratch: Scratch) -> None:
    """Forces that keep stuck ports from accelerating, W M^-1 W^T f = -(W a + bias); adds them to the motion."""
    free, held, matrix, vector = scratch.free, scratch.held, scratch.matrix, scratch.vector
    nv = free.size
    for a in range(stuck):
        p = c[c[FRICTION_PORT] + int(w[c[STUCK] + a])]
        rows = w[c[W_ROWS] + p * nv : c[W_ROWS] + (p + 1) * nv]
        total = w[c[BIAS] + p]
        for i in range(nv):
            held[a, i] = rows[i]
            total += rows[i] * free[i]
        vector[a] = -total
        solve(scratch.factor, split, held[a])
    for a in range(stuck):
        p = c[c[FRICTION_PORT] + int(w[c[STUCK] + a])]
        for b in range(stuck):
            coupling = 0.0
            for i in range(nv):
                coupling += w[c[W_ROWS] + p * nv + i] * held[b, i]
            matrix[a, b] = coupling
    largest = 0.0
    for a in range(stuck):
        largest = max(largest, matrix[a, a])
    for a in range(stuck):  # elimination without pivoting: symmetric positive semidefinite
        if matrix[a, a] <= 1e-12 * largest:
            continue
        for b in range(a + 1, stuck):
            ratio = matrix[b, a] / matrix[a, a]
            for e in range(a, stuck):
                matrix[b, e] -= ratio * matrix[a, e]
            vector[b] -= ratio * vector[a]
    for k in range(stuck):
        a = stuck - 1 - k
        value = vector[a]
        for b in range(a + 1, stuck):
            value -= matrix[a, b] * vector[b]
        # a second friction at the same port finds a zero pivot and carries nothing; the first carries all
        vector[a] = value / matrix[a, a] if matrix[a, a] > 1e-12 * largest else 0.0
    for a in range(stuck):
        w[c[FRICTION] + int(w[c[STUCK] + a])] = vector[a]
        for i in range(nv):
            free[i] += held[a, i] * vector[a]
