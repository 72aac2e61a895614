"""The compiled half of the right-hand side: ports from Pinocchio's Jacobian, forces, sticking, accelerations.

Pinocchio gives, at (q, v): the joint-space inertia M, the bias forces h, and the joint Jacobian J in world axes,
whose linear rows are the velocity of the body point at the world's origin. Everything below is what remains, so
that one evaluation costs little more than Pinocchio itself.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.dynamics.tree_recursion import move_bodies, place_bodies, weigh_bodies
from spacerobot.simulation.multibody.layout import Scratch, bodies_of, layout_inside, scratch_inside, tree_of
from spacerobot.simulation.reduced.arrays import (
    BIAS,
    FORCE,
    FORCES,
    FRICTION,
    FRICTION_PORT,
    FRICTIONS,
    GAIN,
    INPUT_PORT,
    INPUTS,
    PORT,
    PRESS,
    REMEMBERED,
    SLIDE,
    STATE_PORT,
    STATES,
    STUCK,
    TAU,
    W_ROWS,
    Z_RATE,
    D,
    V,
    Z,
)
from spacerobot.simulation.reduced.forces import STICK, act
from spacerobot.simulation.reduced.ports import driven
from spacerobot.support.jit import lean

STRAIGHT, CIRCLE, POINT, HEADING = range(4)
"""Kinds of feature: a joint with one number; with cosine and sine; a frame's displacement; a heading about an axis."""

PLAIN_PORTS, BIASES, ALL = 0.0, 1.0, 2.0
"""What an evaluation needs: rows and rates of the ports that something acts at or reads; their bias accelerations, for
what sticks at ports whose rows turn; everything of all features and ports."""

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
def _along(a: Any, b: Any) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@lean
def _row(motion: Any, mask: Any, n: Any, arm: Any, sign: float, out: Any) -> None:
    """out += sign * velocity along n of the body point at `arm` from the tree's point, per unit velocity."""
    m0 = arm[1] * n[2] - arm[2] * n[1]
    m1 = arm[2] * n[0] - arm[0] * n[2]
    m2 = arm[0] * n[1] - arm[1] * n[0]
    for i in range(out.size):
        if mask[i]:
            s = motion[i]
            out[i] += sign * (n[0] * s[0] + n[1] * s[1] + n[2] * s[2] + m0 * s[3] + m1 * s[4] + m2 * s[5])


@lean
def _drift(bodies: Any, body: int, arm: Any, out: Any) -> None:
    """Angular velocity, velocity and bias acceleration of the body point at `arm`: out shape (3, 3)."""
    for k in range(3):
        for i in range(3):
            out[k, i] = 0.0
    if body < 0:
        return
    s, b = bodies.speed[body], bodies.bias[body]
    for k in range(3):
        out[0, k] = s[3 + k]
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        out[1, k] = s[k] + s[3 + i] * arm[j] - s[3 + j] * arm[i]
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        turn = b[3 + i] * arm[j] - b[3 + j] * arm[i]  # (angular bias) x arm
        out[2, k] = b[k] + turn + s[3 + i] * out[1, j] - s[3 + j] * out[1, i]


@lean
def _put(bodies: Any, body: int, local: Any, out: Any, arm: Any) -> None:
    """A body's point in the world, and from its tree's point."""
    if body < 0:
        for k in range(3):
            out[k] = arm[k] = local[k]
        return
    r, p, o = bodies.rotation[body], bodies.place[body], bodies.point[body]
    for k in range(3):
        arm[k] = p[k] + r[3 * k] * local[0] + r[3 * k + 1] * local[1] + r[3 * k + 2] * local[2]
        out[k] = o[k] + arm[k]


@lean
def _turned(bodies: Any, body: int, local: Any, out: Any) -> None:
    """A body's direction in the world."""
    if body < 0:
        for k in range(3):
            out[k] = local[k]
        return
    r = bodies.rotation[body]
    for k in range(3):
        out[k] = r[3 * k] * local[0] + r[3 * k + 1] * local[1] + r[3 * k + 2] * local[2]


@lean
def sense(c: Any, w: Any, layout: Any, scratch: Any, bodies: Any, q: Any, v: Any, needs: float) -> None:
    """Rows, displacements, rates and bias accelerations of ports, into `w`; `needs` says of which.

    `bodies` is the tree's work: placed, and moved where bias accelerations are needed.
    """
    nv, biased, whole = v.size, needs > 0.0, needs >= ALL
    row, value, place, arm = scratch.row, scratch.value, scratch.place, scratch.arm
    motion, other, vectors = scratch.motion[0], scratch.motion[1], scratch.vectors
    carrier = layout.carrier
    for b in (HAND, TIP, BASE):
        _put(bodies, carrier[b], layout.local[b], place[b], arm[b])
    touch, apart, from_tip, from_target = vectors[0], vectors[1], vectors[2], vectors[3]
    own = carrier[TARGET]
    _put(bodies, own, layout.local[TARGET], touch, from_target)
    for i in range(3):
        arm[TARGET, i] = bodies.place[own, i]
        place[TARGET, i] = bodies.point[own, i] + arm[TARGET, i]
        apart[i] = touch[i] - place[TIP, i]
        from_tip[i] = arm[TIP, i] + apart[i]
    for f in range(row.shape[0]):
        if not (whole or layout.seen[f]):
            continue
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
            _row(bodies.motion, layout.support[a], n, arm[a], 1.0, row[f])
            if biased:
                _drift(bodies, carrier[a], arm[a], motion)
                bias = _along(n, motion[2])
        else:
            turned, up = vectors[4], layout.axes[b]
            _turned(bodies, carrier[a], layout.ahead[f], turned)
            d = np.arctan2(_along(layout.axes[(b + 2) % 3], turned), _along(layout.axes[(b + 1) % 3], turned))
            for i in range(nv):
                if layout.support[a, i]:
                    row[f, i] = _along(up, bodies.motion[i, 3:])
            if biased:
                bias = _along(up, bodies.bias[carrier[a], 3:])
        speed = 0.0
        for i in range(nv):
            speed += row[f, i] * v[i]
        value[f, 0], value[f, 1], value[f, 2] = d, speed, bias
    for p in range(layout.ports.shape[0]):
        if not (whole or layout.used[p]):
            continue
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
    relative = vectors[4]
    if biased:
        _drift(bodies, carrier[TIP], from_tip, other)
        _drift(bodies, own, from_target, motion)
        x, y, z = motion[1, 0] - other[1, 0], motion[1, 1] - other[1, 1], motion[1, 2] - other[1, 2]
        relative[0] = motion[2, 0] - other[2, 0] - 2.0 * (other[0, 1] * z - other[0, 2] * y)
        relative[1] = motion[2, 1] - other[2, 1] - 2.0 * (other[0, 2] * x - other[0, 0] * z)
        relative[2] = motion[2, 2] - other[2, 2] - 2.0 * (other[0, 0] * y - other[0, 1] * x)
    n = vectors[5]
    for k in range(3):
        p = c[PRESS] if k == 0 else c[SLIDE] if k == 1 else layout.rise
        if p < 0:
            continue
        _turned(bodies, carrier[TIP], layout.tip_axes[k], n)
        out = w[c[W_ROWS] + p * nv : c[W_ROWS] + (p + 1) * nv]
        for i in range(nv):
            out[i] = 0.0
        # the face belongs to the tip, the point to the target; both feel the force at the point
        _row(bodies.motion, layout.support[TARGET], n, from_target, 1.0, out)
        _row(bodies.motion, layout.support[TIP], n, from_tip, -1.0, out)
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
    layout: Any,
    scratch: Any,
    bodies: Any,
    q: Any,
    v: Any,
    out: Any,
) -> None:
    """out = d/dt (configuration, velocity, work of every force, friction, state and input, states); after `sense`."""
    nq, nv = q.size, v.size
    stuck = exert(x, c, laws, t, modes, u, w, nv)
    split = layout.split
    _factorise(bodies.inertia, 0, split, scratch.factor)
    _factorise(bodies.inertia, split, nv, scratch.factor)
    free = scratch.free
    for i in range(nv):
        free[i] = w[c[TAU] + i] - bodies.load[i]
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
    at += c[FRICTIONS]
    for s in range(c[STATES]):
        out[at + s] = w[c[REMEMBERED] + s] * w[c[V] + c[c[STATE_PORT] + s]]
        out[at + c[STATES] + c[INPUTS] + s] = w[c[Z_RATE] + s]
    at += c[STATES]
    for j in range(c[INPUTS]):
        out[at + j] = x[c[GAIN] + j] * driven(u, j, t) * w[c[V] + c[c[INPUT_PORT] + j]]


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


@lean
def _recall(c: Any, w: Any, y: Any) -> None:
    """What laws with a memory keep, the last of the ambient state, into the work array."""
    for s in range(c[STATES]):
        w[c[Z] + s] = y[y.size - c[STATES] + s]


@lean
def locate(c: Any, w: Any, ints: Any, floats: Any, work: Any, y: Any, q: Any, v: Any, needs: float) -> None:
    """Configuration, velocity, bodies and ports of an ambient state."""
    layout, scratch = layout_inside(ints, floats), scratch_inside(ints, work)
    tree, bodies = tree_of(ints, floats), bodies_of(ints, work)
    load(y, layout.joints, q, v)
    place_bodies(tree, bodies, q)
    if needs > 0.0:
        move_bodies(tree, bodies, v)
    _recall(c, w, y)
    sense(c, w, layout, scratch, bodies, q, v, needs)


@lean
def rate_of(
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
    y: Any,
    q: Any,
    v: Any,
    needs: float,
    out: Any,
) -> None:
    """out = dy/dt. `ints`, `floats` and `work` hold Layout, Scratch and the tree of bodies."""
    layout, scratch = layout_inside(ints, floats), scratch_inside(ints, work)
    tree, bodies = tree_of(ints, floats), bodies_of(ints, work)
    load(y, layout.joints, q, v)
    place_bodies(tree, bodies, q)
    move_bodies(tree, bodies, v)
    weigh_bodies(tree, bodies)
    _recall(c, w, y)
    sense(c, w, layout, scratch, bodies, q, v, needs)
    accelerate(x, c, laws, t, modes, u, w, layout, scratch, bodies, q, v, out)
