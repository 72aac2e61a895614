"""One Dormand-Prince 5(4) step with dense output. Compiled.

Coefficients: Dormand and Prince (1980); the fourth-order interpolant is Shampine's (1986).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.simulation.reduced.motion import accelerate
from spacerobot.support.jit import lean

_E = np.array([-71 / 57600, 0, 71 / 16695, -71 / 1920, 17253 / 339200, -22 / 525, 1 / 40])
_P = np.array(
    [
        [1, -8048581381 / 2820520608, 8663915743 / 2820520608, -12715105075 / 11282082432],
        [0, 0, 0, 0],
        [0, 131558114200 / 32700410799, -68118460800 / 10900136933, 87487479700 / 32700410799],
        [0, -1754552775 / 470086768, 14199869525 / 1410260304, -10690763975 / 1880347072],
        [0, 127303824393 / 49829197408, -318862633887 / 49829197408, 701980252875 / 199316789632],
        [0, -282668133 / 205662961, 2019193451 / 616988883, -1453857185 / 822651844],
        [0, 40617522 / 29380423, -110615467 / 29380423, 69997945 / 29380423],
    ]
)


@lean
def stages(
    x: Any, c: Any, laws: Any, t: float, y: Any, h: float, modes: Any, u: Any, w: Any, k: Any, temp: Any
) -> None:
    """Fills k[1:] from k[0]; `temp` ends as the new state. Written out: loops over a tableau cost as much again."""
    n = y.size
    for i in range(n):
        temp[i] = y[i] + h * (1 / 5) * k[0, i]
    accelerate(x, c, laws, t + 1 / 5 * h, temp, modes, u, w, k[1])
    for i in range(n):
        temp[i] = y[i] + h * (3 / 40 * k[0, i] + 9 / 40 * k[1, i])
    accelerate(x, c, laws, t + 3 / 10 * h, temp, modes, u, w, k[2])
    for i in range(n):
        temp[i] = y[i] + h * (44 / 45 * k[0, i] - 56 / 15 * k[1, i] + 32 / 9 * k[2, i])
    accelerate(x, c, laws, t + 4 / 5 * h, temp, modes, u, w, k[3])
    for i in range(n):
        temp[i] = y[i] + h * (
            19372 / 6561 * k[0, i] - 25360 / 2187 * k[1, i] + 64448 / 6561 * k[2, i] - 212 / 729 * k[3, i]
        )
    accelerate(x, c, laws, t + 8 / 9 * h, temp, modes, u, w, k[4])
    for i in range(n):
        temp[i] = y[i] + h * (
            9017 / 3168 * k[0, i]
            - 355 / 33 * k[1, i]
            + 46732 / 5247 * k[2, i]
            + 49 / 176 * k[3, i]
            - 5103 / 18656 * k[4, i]
        )
    accelerate(x, c, laws, t + h, temp, modes, u, w, k[5])
    for i in range(n):
        temp[i] = y[i] + h * (
            35 / 384 * k[0, i] + 500 / 1113 * k[2, i] + 125 / 192 * k[3, i] - 2187 / 6784 * k[4, i] + 11 / 84 * k[5, i]
        )
    accelerate(x, c, laws, t + h, temp, modes, u, w, k[6])


@lean
def error_norm(y: Any, new: Any, h: float, k: Any, rtol: float, atol: Any) -> float:
    """Largest error of the step over its tolerance; at most 1 is accepted."""
    worst = 0.0
    for i in range(y.size):
        e = 0.0
        for j in range(7):
            e += _E[j] * k[j, i]
        scale = atol[i] + rtol * max(abs(y[i]), abs(new[i]))
        worst = max(worst, abs(h * e) / scale)
    return worst


ORDER = 4
"""Coefficients of the interpolant."""


@lean
def interpolate(y: Any, h: float, q: Any, order: int, theta: float, out: Any) -> None:
    """State at t + theta h from the first `order` of the step's dense coefficients q, shape (2n, at least order)."""
    for i in range(y.size):
        total = q[i, order - 1]
        for k in range(1, order):
            total = total * theta + q[i, order - 1 - k]
        out[i] = y[i] + h * theta * total


@lean
def dense(k: Any, q: Any) -> None:
    """Coefficients of the interpolant, the first ORDER of q, shape (N, .), from the stages k shape (7, N)."""
    for i in range(q.shape[0]):
        for c in range(ORDER):
            total = 0.0
            for j in range(7):
                total += k[j, i] * _P[j, c]
            q[i, c] = total
