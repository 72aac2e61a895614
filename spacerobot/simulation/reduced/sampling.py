"""Reading a recorded integration: states and forces at any time, work done by each element. Compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.effects.kernel import PARAMETERS
from spacerobot.simulation.polynomial import value
from spacerobot.simulation.reduced.affine import DEGREE
from spacerobot.simulation.reduced.arrays import (
    CONSTANT,
    CONTACT_FORCE,
    FORCE,
    FORCES,
    FRICTION,
    FRICTION_PORT,
    FRICTIONS,
    LIVE_PORTS,
    PARAMETER,
    PORT,
    PRESS,
    REMEMBERED,
    STATE_PORT,
    STATES,
    TAU,
    W_ROWS,
    N,
    V,
)
from spacerobot.simulation.reduced.forces import PRESSED, say
from spacerobot.simulation.reduced.motion import accelerate, evaluate
from spacerobot.simulation.reduced.ports import kinematics
from spacerobot.simulation.reduced.stepper import ORDER, interpolate
from spacerobot.support.jit import jit, lean, lean_sum


def _gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (nodes + 1.0), 0.5 * weights


_NODES, _WEIGHTS = _gauss(5)
_MANY_NODES, _MANY_WEIGHTS = _gauss(12)  # straight steps are long


@lean
def _step_at(time: Any, length: Any, step: int, t: float) -> Any:
    """The step that holds time t, looked for from `step` on, and where in it."""
    last = time.size - 1
    if t < time[step]:
        step = 0
    while step < last and t >= time[step + 1]:
        step += 1
    theta = 0.0
    if length[step] > 0.0:
        theta = min(max((t - time[step]) / length[step], 0.0), 1.0)
    return step, theta


@jit
def sample_states(time: Any, length: Any, state: Any, dense: Any, order: Any, at: Any, count: int) -> Any:
    """The first `count` numbers of the states at the times `at`, shape (T, count), without any force."""
    out, powers = np.empty((at.size, count)), np.empty(DEGREE)
    step = 0
    for i in range(at.size):
        step, theta = _step_at(time, length, step, at[i])
        if order[step] == DEGREE:
            _along(state[step, :count], length[step], dense[step], theta, powers, out[i])
        else:
            interpolate(state[step, :count], length[step], dense[step], order[step], theta, out[i])
    return out


@lean_sum
def _along(y: Any, h: float, q: Any, theta: float, powers: Any, out: Any) -> None:
    """State at t + theta h of a series; `powers` is room for DEGREE numbers."""
    power = 1.0
    for k in range(DEGREE):
        power *= theta
        powers[k] = power
    for i in range(y.size):
        total = 0.0
        for k in range(DEGREE):
            total += q[i, k] * powers[k]
        out[i] = y[i] + h * total


@jit
def sample_accelerations(
    x: Any, c: Any, laws: Any, w: Any, time: Any, length: Any, state: Any, dense: Any, order: Any, modes: Any, at: Any,
    u: Any,
) -> Any:  # fmt: skip
    """Accelerations at the times `at` (ascending), shape (T, n): of a series its slope, elsewhere by the forces."""
    n, size = c[N], state.shape[1]
    out, y, rate = np.zeros((at.size, n)), np.empty(size), np.empty(size)
    last, step = time[time.size - 1] + length[time.size - 1], 0
    for i in range(at.size):
        step, theta = _step_at(time, length, step, at[i])
        degree = order[step]
        if degree == ORDER or not time[0] <= at[i] <= last:
            interpolate(state[step], length[step], dense[step], degree, theta, y)
            accelerate(x, c, laws, at[i], y, modes[step], u, w, rate)
            for j in range(n):
                out[i, j] = rate[n + j]
            continue
        for j in range(n):
            total = degree * dense[step, n + j, degree - 1]
            for k in range(1, degree):
                total = total * theta + (degree - k) * dense[step, n + j, degree - 1 - k]
            out[i, j] = total
    return out


@jit
def sample_contact(
    x: Any, c: Any, laws: Any, w: Any, time: Any, length: Any, state: Any, dense: Any, order: Any, modes: Any, at: Any
) -> Any:
    """Contact force, positive in compression, at the times `at`, shape (T,); nothing is evaluated while apart."""
    out = np.zeros(at.size)
    y, p = np.empty(state.shape[1]), np.empty(DEGREE + 1)
    last = time.size - 1
    force, row, n = c[CONTACT_FORCE], c[W_ROWS] + c[PRESS] * c[N], c[N]
    first_of = c[PARAMETER] + PARAMETERS * force
    for step in range(time.size):
        if modes[step, 0] != PRESSED:
            continue
        h, q = length[step], dense[step]
        first = 0 if step == 0 else np.searchsorted(at, time[step])
        end = at.size if step == last else np.searchsorted(at, time[step + 1])
        if order[step] == DEGREE:  # then the contact is linear too, and its force one polynomial
            stiffness, damping = x[first_of], x[first_of + 1]
            p[:] = 0.0
            for i in range(n):
                p[0] += w[row + i] * (stiffness * state[step, i] + damping * state[step, n + i])
                for k in range(DEGREE):
                    p[k + 1] += h * w[row + i] * (stiffness * q[i, k] + damping * q[n + i, k])
        for i in range(first, end):
            theta = min(max((at[i] - time[step]) / h, 0.0), 1.0) if h > 0.0 else 0.0
            if order[step] == DEGREE:
                out[i] = value(p, DEGREE, theta)
            else:
                interpolate(state[step], h, q, order[step], theta, y)
                kinematics(x, c, y, w, c[LIVE_PORTS])
                out[i] = -say(x, c, laws, modes[step], w, force)
    return out


@jit
def sample(
    x: Any,
    c: Any,
    laws: Any,
    w: Any,
    time: Any,
    length: Any,
    state: Any,
    dense: Any,
    order: Any,
    modes: Any,
    at: Any,
    u: Any,
) -> Any:
    """States and forces at the times `at` (ascending): shapes (T, 2n + S), the same of derivatives, (T, F), (T, R + S).

    At an event's own time the side after it is shown. Outside the record the nearest end is held.
    """
    size = state.shape[1]
    out, rate = np.empty((at.size, size)), np.empty((at.size, size))
    force, friction = np.empty((at.size, c[FORCES])), np.empty((at.size, c[FRICTIONS] + c[STATES]))
    step = 0
    for i in range(at.size):
        step, theta = _step_at(time, length, step, at[i])
        interpolate(state[step], length[step], dense[step], order[step], theta, out[i])
        evaluate(x, c, laws, at[i], out[i], modes[step], u, w, rate[i])
        for j in range(c[FORCES]):
            force[i, j] = w[c[FORCE] + j]
        for j in range(c[FRICTIONS]):
            friction[i, j] = w[c[FRICTION] + j]
        for j in range(c[STATES]):
            friction[i, c[FRICTIONS] + j] = w[c[REMEMBERED] + j]
    return out, rate, force, friction


@jit
def work_done(
    x: Any, c: Any, laws: Any, w: Any, time: Any, length: Any, state: Any, dense: Any, order: Any, modes: Any, u: Any
) -> Any:
    """Work [J] that each force, friction and law with a memory did up to every step's end, (m + 1, F + R + S + n + 1).

    The last n columns are the fields' work per coordinate, the very last that of the recorded drives.
    """
    size = state.shape[1]
    n, forces, frictions = c[N], c[FORCES], c[FRICTIONS]
    acting = forces + frictions + c[STATES]
    total = np.zeros((time.size + 1, acting + n + 1))
    y, rate = np.empty(size), np.empty(size)
    for m in range(time.size):
        for column in range(total.shape[1]):
            total[m + 1, column] = total[m, column]
        nodes, weights = (_NODES, _WEIGHTS) if order[m] == ORDER else (_MANY_NODES, _MANY_WEIGHTS)
        for g in range(nodes.size):
            interpolate(state[m], length[m], dense[m], order[m], nodes[g], y)
            t = time[m] + nodes[g] * length[m]
            evaluate(x, c, laws, t, y, modes[m], u, w, rate)
            dt = weights[g] * length[m]
            power = 0.0
            for i in range(n):
                power += w[c[TAU] + i] * y[n + i]
            for j in range(forces):
                done = w[c[FORCE] + j] * w[c[V] + c[c[PORT] + j]]
                total[m + 1, j] += done * dt
                power -= done
            for r in range(frictions):
                done = w[c[FRICTION] + r] * w[c[V] + c[c[FRICTION_PORT] + r]]
                total[m + 1, forces + r] += done * dt
                power -= done
            for s in range(c[STATES]):
                done = w[c[REMEMBERED] + s] * w[c[V] + c[c[STATE_PORT] + s]]
                total[m + 1, forces + frictions + s] += done * dt
                power -= done
            for i in range(n):
                done = x[c[CONSTANT] + i] * y[n + i]
                total[m + 1, acting + i] += done * dt
                power -= done
            total[m + 1, acting + n] += power * dt
    return total
