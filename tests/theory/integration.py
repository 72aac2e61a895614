"""Independent integration that the theory is tested against: scipy's DOP853, nothing of the package."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp


@dataclass(frozen=True)
class Hit:
    time: float
    restitution: float
    peak_deflection: float
    peak_force: float


def hit(force: Callable[[float, float], float], mass: float, speed: float, end: str, scale: float) -> Hit:
    """One mass against force(x, v), from x = 0, until x = 0 again or until the force vanishes."""

    def field(t: float, y: np.ndarray) -> list[float]:
        return [y[1], -force(y[0], y[1]) / mass]

    def stopped(t: float, y: np.ndarray) -> float:
        return y[1]

    def ended(t: float, y: np.ndarray) -> float:
        return y[0] if end == "displacement_zero" else force(y[0], y[1])

    stopped.terminal, stopped.direction = True, -1
    ended.terminal, ended.direction = True, -1
    options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-16 * scale, "dense_output": True}
    first = solve_ivp(field, (0, 100 * scale), [0.0, speed], events=stopped, **options)
    x_max = float(first.y[0, -1])
    samples = first.sol(np.linspace(0, first.t[-1], 20001))
    peak = max(force(x, v) for x, v in samples.T)
    # a hair beyond the turning point, so that friction has its new sign
    second = solve_ivp(field, (0, 100 * scale), [x_max, -1e-300], events=ended, **options)
    if not len(second.t_events[0]):
        return Hit(math.inf, 0.0, x_max, peak)
    return Hit(float(first.t[-1] + second.t[-1]), -float(second.y[1, -1]) / speed, x_max, peak)
