"""Balls dropped in air, as studies: heavy ones do not feel it, light ones do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from spacerobot.recordings.study import Study, load_study

GRAVITY = 9.80665

HEAD = """format = 1
title = "Balls"
[baseline]
base = "free"
approach = [0, 0, -1]
gravity = [0, 0, -9.80665]
[baseline.body]
mass = "unknown"
[streams.video]
time = "t"
[streams.video.channels]
z = {{ is = "body.position.z"{noise} }}
"""


def balls(
    folder: Path,
    dropped: Mapping[str, tuple[float, float]],
    *,
    stated: bool = True,
    noise: float = 0.05,
    beside: Sequence[str] = (),
) -> Study:
    """Two drops of each ball, name -> (mass [kg], drag [N s^2/m^2]); its readings hang on no other ball.

    `beside` are channels that are recorded too, as the number of the reading.
    """
    folder.mkdir(exist_ok=True)
    text = [HEAD.format(noise=f", sigma = {noise}" if stated else "")]
    text += [f'"{name}" = {{ is = "{name}" }}\n' for name in beside]
    head = ",".join(["t,z", *beside]) + "\n"
    time = np.linspace(0.0, 2.6, 40)
    for name, (mass, drag) in dropped.items():
        random = np.random.default_rng([*name.encode()])
        for k in range(2):
            start = [35.0, random.normal(0.0, 0.3)]
            path = solve_ivp(
                lambda t, y, k=drag / mass: [y[1], -GRAVITY - k * abs(y[1]) * y[1]],
                (0.0, time[-1]), start, t_eval=time, rtol=1e-9, atol=1e-9,
            ).y[0]  # fmt: skip
            rows = zip(time, path + noise * random.standard_normal(time.size), strict=True)
            lines = [f"{t:.6f},{z:.6f}" + f",{n}" * len(beside) + "\n" for n, (t, z) in enumerate(rows)]
            (folder / f"{name}_{k}.csv").write_text(head + "".join(lines))
            text.append(f'[[trials]]\nid = "{name}_{k}"\ncondition = "{name}"\nbody.mass = {mass}\n')
            text.append(f'video = "{name}_{k}.csv"\n')
    (folder / "study.toml").write_text("".join(text))
    return load_study(folder)
