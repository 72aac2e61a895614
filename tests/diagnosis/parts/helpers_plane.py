"""A body in the plane past a camera, sliding obliquely or knocked in single trials, as a study."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from spacerobot.recordings.study import Study, load_study

MASS, INERTIA, NOISE, SECONDS, READINGS = 4.0, 0.05, 0.001, 6.0, 120

HEAD = f"""format = 1
title = "In the plane"
[baseline]
base = "free"
approach = [1, 0, 0]
gravity = [0, 0, -9.80665]
[baseline.body]
mass = {MASS}
yaw_inertia = {INERTIA}
[streams.camera]
time = "t"
[streams.camera.channels]
x = {{ is = "body.position.x" }}
y = {{ is = "body.position.y" }}
yaw = {{ is = "body.yaw" }}
"""

STARTS = ((0.30, 0.22, 0.1), (0.42, -0.18, -0.2), (0.25, 0.40, 0.15), (0.50, 0.10, 0.05))
"""Velocities along, across [m/s] and about [rad/s] of the trials' starts."""

Knock = tuple[float, tuple[float, float, float]]
"""(when [s], (along, across [N s], about [N m s]))."""


def in_plane(
    folder: Path,
    force: Callable[[np.ndarray], np.ndarray] = lambda v: 0.0 * v,
    knocks: Mapping[int, Knock] | None = None,
    seed: int = 0,
    lasting: float = 0.0,
    pull: Callable[[np.ndarray], np.ndarray] = lambda state: np.zeros(3),
    turning: float = 1.0,
) -> Study:
    """One slide from each start under a force of the velocity [N], with knocks in some of them.

    Such a knock may be a steady push that begins then and lasts [s]. What pulls besides, along, across and about
    [N, N m], is a function of the state, shape (6,). They turn so many times as fast as usual.
    """
    folder.mkdir(exist_ok=True, parents=True)
    random, text = np.random.default_rng(seed), [HEAD]
    time = np.linspace(0.0, SECONDS, READINGS)
    inertia = np.array([MASS, MASS, INERTIA])

    def rate(t: float, y: np.ndarray, push: np.ndarray) -> np.ndarray:
        return np.concatenate([y[3:], (np.append(force(y[3:5]), 0.0) + pull(y) + push) / inertia])

    for number, start in enumerate(STARTS):
        when, impulse = (knocks or {}).get(number, (SECONDS, (0.0, 0.0, 0.0)))
        shown = np.zeros((3, READINGS))
        state, begin = np.array([0.0, 0.0, 0.0, *start[:2], turning * start[2]]), 0.0
        given = np.array(impulse)
        pushed = [(when + lasting, given / lasting)] if lasting and when < SECONDS else []
        for end, push in ((when, np.zeros(3)), *pushed, (SECONDS + 1e-9, np.zeros(3))):
            run = solve_ivp(rate, (begin, end), state, args=(push,), rtol=1e-8, atol=1e-9, dense_output=True)
            here = (time >= begin) & (time <= end)
            shown[:, here] = run.sol(time[here])[:3]
            state, begin = run.y[:, -1].copy(), end
            if end == when and not lasting:
                state[3:] += given / inertia
        shown = shown + NOISE * random.standard_normal(shown.shape)
        rows = "".join(f"{t:.6f},{x:.7f},{y:.7f},{a:.7f}\n" for t, (x, y, a) in zip(time, shown.T, strict=True))
        (folder / f"{number}.csv").write_text("t,x,y,yaw\n" + rows)
        text.append(f'[[trials]]\nid = "s{number}"\ncamera = "{number}.csv"\n')
    (folder / "study.toml").write_text("".join(text))
    return load_study(folder)
