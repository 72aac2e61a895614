"""Machines whose hidden law is written here: one joint that a drive moves, a body that slides to rest."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from spacerobot.recordings.study import Study, load_study

INERTIA, NOISE, SECONDS, RATE, REACH = 0.02, 0.02, 5.0, 200.0, 1.2
SPEEDS = (0.6, 1.0, 1.6)
MASS, TRACKED = 4.0, 5e-4

ROTOR = f"""<robot name="rig">
  <link name="base"><inertial><mass value="1"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="rotor"><inertial><mass value="2"/>
    <inertia ixx="{INERTIA}" ixy="0" ixz="0" iyy="{INERTIA}" iyz="0" izz="{INERTIA}"/></inertial></link>
  <joint name="shaft" type="revolute"><parent link="base"/><child link="rotor"/><axis xyz="0 0 1"/>
    <limit lower="-30" upper="30" effort="50" velocity="50"/></joint></robot>"""

JOINT = f"""format = 1
title = "One joint"
[baseline]
robot = "rig.urdf"
base = "fixed"
joints = "free"
gravity = [0, 0, 0]
[baseline.sigma]
"joint.shaft.mass" = 0.05
[streams.log]
time = "t"
[streams.log.channels]
q = {{ is = "joint.shaft.position", sigma = 2e-5 }}
w = {{ is = "joint.shaft.velocity", sigma = 1e-3 }}
[streams.torques]
time = "t"
[streams.torques.channels]
tau = {{ is = "joint.shaft.torque", use = "input", sigma = {NOISE} }}
"""

BODY = f"""format = 1
title = "One body"
[baseline]
base = "free"
approach = [1, 0, 0]
gravity = [0, 0, -9.80665]
[baseline.body]
mass = {MASS}
[streams.camera]
time = "t"
[streams.camera.channels]
x = {{ is = "body.position.x", sigma = {TRACKED} }}
"""

Law = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""(angle, rate), shape (T,) each -> torque that the drive must overcome, shape (T,) [N m]."""


def joint(folder: Path, law: Law, seed: int = 0, trials: int = 6) -> Study:
    """Logs of a rotor along smooth paths, two at each of three speeds."""
    folder.mkdir(exist_ok=True, parents=True)
    random, text = np.random.default_rng(seed), [JOINT]
    (folder / "rig.urdf").write_text(ROTOR)
    for number in range(trials):
        speed = SPEEDS[number % 3]
        time = np.arange(0.0, SECONDS, 1.0 / RATE)
        q, v, a = np.zeros((3, time.size))
        for k in range(1, 5):
            w = 2.0 * np.pi * k / SECONDS
            sine, cosine = random.uniform(-1.0, 1.0, 2) / k
            q += sine * np.sin(w * time) + cosine * (np.cos(w * time) - 1.0)
            v += w * (sine * np.cos(w * time) - cosine * np.sin(w * time))
            a -= w * w * (sine * np.sin(w * time) + cosine * np.cos(w * time))
        scale = REACH / np.abs(q).max()
        time, q, v, a = time / speed, scale * q, scale * speed * v, scale * speed**2 * a
        torque = INERTIA * a + law(q, v) + NOISE * random.standard_normal(time.size)
        log = np.c_[time, q + 2e-5 * random.standard_normal(q.size), v + 1e-3 * random.standard_normal(q.size)]
        np.savetxt(folder / f"j{number}.csv", log, "%.7g", ",", header="t,q,w", comments="")
        np.savetxt(folder / f"t{number}.csv", np.c_[time, torque], "%.7g", ",", header="t,tau", comments="")
        text.append(f'[[trials]]\nid = "r{number}"\ncondition = "{speed}"\n')
        text.append(f'log = "j{number}.csv"\ntorques = "t{number}.csv"\n')
    (folder / "study.toml").write_text("".join(text))
    return load_study(folder)


def body(folder: Path, force: Callable[[float, float], float], starts: tuple[float, ...], seed: int = 0) -> Study:
    """Slides along one line from each of these speeds [m/s], under a force of place and rate [N]."""
    folder.mkdir(exist_ok=True, parents=True)
    random, text = np.random.default_rng(seed), [BODY]
    time = np.linspace(0.0, 6.0, 240)
    for number, start in enumerate(starts):
        run = solve_ivp(
            lambda t, y: [y[1], force(y[0], y[1]) / MASS],
            (0.0, 6.0 + 1e-9),
            [0.0, start],
            rtol=1e-9,
            atol=1e-11,
            max_step=0.01,
            dense_output=True,
        )
        track = np.c_[time, run.sol(time)[0] + TRACKED * random.standard_normal(time.size)]
        np.savetxt(folder / f"b{number}.csv", track, "%.7g", ",", header="t,x", comments="")
        text.append(f'[[trials]]\nid = "s{number}"\ncamera = "b{number}.csv"\n')
    (folder / "study.toml").write_text("".join(text))
    return load_study(folder)
