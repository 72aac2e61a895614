"""A planar arm of two links by its textbook equations (Craig 2005, Sec. 6.7, with links' own inertia): no Pinocchio."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from spacerobot.recordings.study import Study, load_study
from tests.overlay.studies import write_csv

MASS, LENGTH, CENTRE, INERTIA = (1.2, 0.7), 0.4, (0.2, 0.15), (0.02, 0.006)
GRAVITY = 9.81
JOINTS = ("shoulder", "elbow")

Friction = Callable[[np.ndarray], np.ndarray]
"""Torques that oppose the joints' rates, shape (2, ...) both."""


def link(name: str, k: int) -> str:
    own = f'ixx="{INERTIA[k]}" ixy="0" ixz="0" iyy="{INERTIA[k]}" iyz="0" izz="1e-3"'
    return f"""<link name="{name}"><inertial><origin xyz="0 0 {-CENTRE[k]}"/><mass value="{MASS[k]}"/>
    <inertia {own}/></inertial></link>"""


URDF = f"""<robot name="arm"><link name="stand"><inertial><mass value="9"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  {link("upper", 0)}{link("lower", 1)}
  <joint name="shoulder" type="continuous"><parent link="stand"/><child link="upper"/><axis xyz="0 1 0"/></joint>
  <joint name="elbow" type="continuous"><origin xyz="0 0 {-LENGTH}"/>
    <parent link="upper"/><child link="lower"/><axis xyz="0 1 0"/></joint></robot>"""


def inertia(q: np.ndarray) -> np.ndarray:
    """Of the joints, shape (2, 2, ...)."""
    (m1, m2), (c1, c2), (i1, i2) = MASS, CENTRE, INERTIA
    both = m2 * LENGTH * c2 * np.cos(q[1])
    own = i2 + m2 * c2**2
    first = i1 + m1 * c1**2 + m2 * LENGTH**2 + own + 2.0 * both
    return np.array([[first, own + both], [own + both, own + 0.0 * both]])


def rest(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Centrifugal, Coriolis and weight torques, shape (2, ...)."""
    (m1, m2), (c1, c2) = MASS, CENTRE
    turn = -m2 * LENGTH * c2 * np.sin(q[1])
    low = m2 * c2 * GRAVITY * np.sin(q[0] + q[1])
    high = (m1 * c1 + m2 * LENGTH) * GRAVITY * np.sin(q[0])
    return np.array([turn * (2.0 * v[0] * v[1] + v[1] ** 2) + high + low, -turn * v[0] ** 2 + low])


def torque(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    return np.einsum("ij...,j...->i...", inertia(q), a) + rest(q, v)


def swung(release: Sequence[float], time: np.ndarray, friction: Friction) -> np.ndarray:
    """Angles of both joints let go of at rest, shape (2, T)."""

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        q, v = y[:2], y[2:]
        return np.concatenate([v, np.linalg.solve(inertia(q), -rest(q, v) - friction(v))])

    found = solve_ivp(rate, (0.0, time[-1]), [*release, 0.0, 0.0], t_eval=time, rtol=1e-9, atol=1e-10, max_step=0.01)
    return np.asarray(found.y[:2])


def moved(time: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """An exciting motion of both joints: place, rate and acceleration, shape (2, T) each."""
    random = np.random.default_rng(seed)
    w = 2.0 * np.pi * np.array([[0.23, 0.51, 0.83], [0.31, 0.59, 0.97]])
    size, phase = random.uniform(0.2, 0.5, (2, 3, 1)) / w[..., None] * 2.0, random.uniform(0.0, 6.3, (2, 3, 1))
    angle = w[..., None] * time + phase
    w = w[..., None]
    return (size * np.sin(angle)).sum(1), (size * w * np.cos(angle)).sum(1), (-size * w**2 * np.sin(angle)).sum(1)


def written(folder: Path, logs: Sequence[dict[str, np.ndarray]], sigma: str = "") -> Study:
    """A study of logs with columns t, q0, q1 and perhaps u0, u1; what is not logged is zero."""
    (folder / "arm.urdf").write_text(URDF)
    for n, log in enumerate(logs):
        write_csv(folder / f"{n}.csv", log)
    channels = "".join(f'q{k} = {{ is = "joint.{j}.position" }}\n' for k, j in enumerate(JOINTS))
    idle = ""
    for k, j in enumerate(JOINTS):
        if f"u{k}" in logs[0]:
            channels += f'u{k} = {{ is = "joint.{j}.torque", use = "input" }}\n'
        else:
            idle += f"{j}.torque = 0\n"
    trials = "".join(f'[[trials]]\nid = "s{n}"\nlog = "{n}.csv"\n' for n in range(len(logs)))
    (folder / "study.toml").write_text(
        f"""format = 1
[baseline]
robot = "arm.urdf"
base = "fixed"
joints = "free"
gravity = [0, 0, -{GRAVITY}]
[baseline.joint]
shoulder.damping = 0.0
elbow.damping = 0.0
{idle}{sigma}
[streams.log]
time = "t"
[streams.log.channels]
{channels}{trials}"""
    )
    return load_study(folder)
