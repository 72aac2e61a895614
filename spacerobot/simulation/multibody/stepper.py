"""One step of the Runge-Kutta method in `dop853`, its error and its interpolant. Compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacerobot.simulation.multibody.dop853 import ALL_STAGES, E3, E5, POWERS, STAGES, A, D
from spacerobot.support.jit import lean


@lean
def stage(y: Any, k: Any, number: int, h: float, out: Any) -> None:
    """out = y + h sum_j A[number, j] k[j]; stage 12 is the step's end."""
    for i in range(y.size):
        out[i] = 0.0
    for j in range(number):
        a = A[number, j]
        if a != 0.0:
            for i in range(y.size):
                out[i] += a * k[j, i]
    for i in range(y.size):
        out[i] = y[i] + h * out[i]


@lean
def error_norm(k: Any, h: float, scale: Any) -> float:
    """Error of the step over its tolerance, at most 1 if accepted; k holds stages 0 to 12.

    Hairer's combination of the estimates of order 5 and 3, as a sum over the states and not their mean: a few
    states decide in a contact, and many others must not dilute them.
    """
    fifth, third = 0.0, 0.0
    for i in range(scale.size):
        five, three = 0.0, 0.0
        for j in range(STAGES + 1):
            five += E5[j] * k[j, i]
            three += E3[j] * k[j, i]
        fifth += (five / scale[i]) ** 2
        third += (three / scale[i]) ** 2
    if fifth == 0.0 and third == 0.0:
        return 0.0
    return abs(h) * fifth / np.sqrt(fifth + 0.01 * third)


@lean
def interpolant(y: Any, new: Any, k: Any, h: float, f: Any) -> None:
    """Coefficients of the interpolant, f shape (POWERS, N), from all 16 stages."""
    for i in range(y.size):
        change = new[i] - y[i]
        f[0, i] = change
        f[1, i] = h * k[0, i] - change
        f[2, i] = 2.0 * change - h * (k[STAGES, i] + k[0, i])
        for p in range(POWERS - 3):
            total = 0.0
            for j in range(ALL_STAGES):
                total += D[p, j] * k[j, i]
            f[3 + p, i] = h * total


@lean
def interpolate(y: Any, f: Any, theta: float, out: Any) -> None:
    """State at the fraction `theta` of the step."""
    for i in range(y.size):
        value = 0.0
        for p in range(POWERS):
            power = POWERS - 1 - p
            value += f[power, i]
            value *= theta if p % 2 == 0 else 1.0 - theta
        out[i] = y[i] + value
