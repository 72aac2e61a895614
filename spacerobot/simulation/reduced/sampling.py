"""Reading a recorded integration: states, accelerations and forces at any time; work done by each element. Compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.simulation.reduced.motion import evaluate
from spacerobot.simulation.reduced.stepper import interpolate
from spacerobot.support.jit import jit

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)
_NODES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS


@jit
def sample(
    s: Any,
    laws: Any,
    w: Any,
    time: Any,
    length: Any,
    state: Any,
    dense: Any,
    modes: Any,
    at: Any,
    it: Any,
    iu: Any,
) -> Any:
    """States and forces at the times `at` (ascending), shapes (T, 2n), (T, 2n) derivative, (T, F), (T, R).

    At an event's own time the side after it is shown. Outside the record the nearest end is held.
    """
    size = state.shape[1]
    out, rate = np.empty((at.size, size)), np.empty((at.size, size))
    force, friction = np.empty((at.size, w.force.size)), np.empty((at.size, w.friction.size))
    step = 0
    last = time.size - 1
    for i in range(at.size):
        if i > 0 and at[i] < at[i - 1]:
            step = 0
        while step < last and at[i] >= time[step + 1]:
            step += 1
        theta = 0.0
        if length[step] > 0.0:
            theta = min(max((at[i] - time[step]) / length[step], 0.0), 1.0)
        interpolate(state[step], length[step], dense[step], theta, out[i])
        evaluate(s, laws, at[i], out[i], modes[step], it, iu, w, rate[i])
        for j in range(w.force.size):
            force[i, j] = w.force[j]
        for j in range(w.friction.size):
            friction[i, j] = w.friction[j]
    return out, rate, force, friction


@jit
def work_done(
    s: Any, laws: Any, w: Any, time: Any, length: Any, state: Any, dense: Any, modes: Any, it: Any, iu: Any
) -> Any:
    """Work [J] that each force and friction did up to the end of every step, shape (m + 1, F + R + n + 1).

    The last n columns are the fields' work per coordinate, the very last that of the recorded drives.
    """
    size = state.shape[1]
    n = size // 2
    forces, frictions = w.force.size, w.friction.size
    total = np.zeros((time.size + 1, forces + frictions + n + 1))
    y, rate = np.empty(size), np.empty(size)
    for m in range(time.size):
        for c in range(total.shape[1]):
            total[m + 1, c] = total[m, c]
        for g in range(_NODES.size):
            interpolate(state[m], length[m], dense[m], _NODES[g], y)
            t = time[m] + _NODES[g] * length[m]
            evaluate(s, laws, t, y, modes[m], it, iu, w, rate)
            dt = _WEIGHTS[g] * length[m]
            power = 0.0
            for i in range(n):
                power += w.tau[i] * y[n + i]
            for j in range(forces):
                done = w.force[j] * w.rate[s.force_port[j]]
                total[m + 1, j] += done * dt
                power -= done
            for r in range(frictions):
                done = w.friction[r] * w.rate[s.friction_port[r]]
                total[m + 1, forces + r] += done * dt
                power -= done
            for i in range(n):
                done = s.constant[i] * y[n + i]
                total[m + 1, forces + frictions + i] += done * dt
                power -= done
            total[m + 1, forces + frictions + n] += power * dt
    return total
