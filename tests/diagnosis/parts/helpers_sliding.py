"""A body that slides over a table past a camera, with something planted in it, as a study; cheap to diagnose."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from spacerobot.recordings.study import Study, load_study

MASS, NOISE, SECONDS, READINGS = 4.0, 0.002, 3.0, 40
SPEEDS = (0.2, 0.3, 0.4, 0.5)

HEAD = """format = 1
title = "Sliding"
[baseline]
base = "free"
approach = [1, 0, 0]
gravity = [0, 0, 0]
[baseline.body]
mass = {mass}
[streams.camera]
time = "t"
[streams.camera.channels]
x = {{ is = "body.position.x"{noise} }}
"""

DECELERATIONS = {
    "viscous_drag": lambda v: v,
    "quadratic_drag": lambda v: abs(v) * v,
    "coulomb_friction": lambda v: np.tanh(v / 1e-4),
}
"""By effect, force over its coefficient."""


def sliding(
    folder: Path,
    effect: str = "",
    size: float = 0.0,
    *,
    seed: int = 0,
    stated: bool = True,
    noise: float = NOISE,
    speeds: Sequence[float] = SPEEDS,
) -> Study:
    """One slide at each of these speeds, with an effect of this size in all of them and noise of its own."""
    folder.mkdir(exist_ok=True, parents=True)
    random = np.random.default_rng(seed)
    text = [HEAD.format(mass=MASS, noise=f", sigma = {noise}" if stated else "")]
    time = np.linspace(0.0, SECONDS, READINGS)
    for number, speed in enumerate(speeds):
        path = speed * time
        if size:
            law = DECELERATIONS[effect]
            path = solve_ivp(
                lambda t, y, law=law: [y[1], -size / MASS * law(y[1])],
                (0.0, SECONDS), [0.0, speed], t_eval=time, rtol=1e-8, atol=1e-10,
            ).y[0]  # fmt: skip
        shown = path + noise * random.standard_normal(time.size)
        rows = "".join(f"{t:.6f},{x:.7f}\n" for t, x in zip(time, shown, strict=True))
        (folder / f"{number}.csv").write_text("t,x\n" + rows)
        text.append(f'[[trials]]\nid = "s{number}"\ncamera = "{number}.csv"\n')
    (folder / "study.toml").write_text("".join(text))
    return load_study(folder)
