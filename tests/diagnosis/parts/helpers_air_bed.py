"""An air bed under commands that hold for half a second, its track and its commands logged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

MASS, INERTIA, NOISE, STEP, HELD = 12.0, 0.2, 5e-4, 0.05, 0.5
INERTIAS = np.array([MASS, MASS, INERTIA])


def head(title: str, thrust: str = "") -> str:
    """Of the study; `thrust` is what the lab says of both channels of force besides."""
    return f"""format = 1
title = "{title}"
[baseline]
base = "free"
gravity = [0, 0, -9.80665]
[baseline.body]
mass = {MASS}
yaw_inertia = {INERTIA}
[streams.log]
time = "t"
[streams.log.channels]
x = {{ is = "body.position.x" }}
y = {{ is = "body.position.y" }}
yaw = {{ is = "body.yaw" }}
fx = {{ is = "body.force.x", use = "input"{thrust} }}
fy = {{ is = "body.force.y", use = "input"{thrust} }}
tz = {{ is = "body.torque.yaw", use = "input" }}
"""


LEVELS = np.array([0.4, 0.4, 0.02])
"""Forces and torque of a command [N, N, N m]."""


def flown(
    folder: Path,
    run: int,
    level: np.ndarray,
    push: Callable[[np.ndarray, float], np.ndarray],
    start: Sequence[float],
    seconds: float,
    random: np.random.Generator,
) -> str:
    """One run written as a log; what the study says of it.

    Args:
        folder: of the study.
        run: its number.
        level: commands, each held in turn, shape (K, 3) [N, N, N m].
        push: forces and torque in the world, shape (3,), of a command and of the yaw [rad].
        start: place, yaw and their rates, shape (6,).
        seconds: that it lasts.
        random: of the noise.
    """
    time = np.arange(0.0, seconds, STEP)

    def held(t: np.ndarray | float) -> np.ndarray:
        return level[np.asarray(t / HELD + 1e-9, dtype=int)]

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate([y[3:], push(held(t), float(y[2])) / INERTIAS])

    moved = solve_ivp(rate, (0.0, seconds), start, t_eval=time, max_step=0.05, rtol=1e-8, atol=1e-10).y[:3].T
    moved = moved + NOISE * random.standard_normal(moved.shape)
    rows = np.column_stack([time, moved, held(time)])
    np.savetxt(folder / f"{run}.csv", rows, "%.7g", ",", header="t,x,y,yaw,fx,fy,tz", comments="")
    return f'[[trials]]\nid = "r{run}"\nlog = "{run}.csv"\n'
