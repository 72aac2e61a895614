"""Planted recordings for the models, and the real ones where they are."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.model.robot import Robot
from spacerobot.recordings.dataroot import recordings_folder
from spacerobot.recordings.study import Study, load_study

STUDIES = Path(__file__).resolve().parents[3] / "examples" / "studies" / "real"

ARM = """<robot name="arm">
  <link name="base"><inertial><mass value="1"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.03"/></inertial></link>
  <link name="fore"><inertial><origin xyz="0.15 0 0"/><mass value="1"/>
    <inertia ixx="0.005" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="50" velocity="5"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.4 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="50" velocity="5"/></joint>
</robot>"""


def real_study(name: str) -> Study:
    """The study of a real recording; the test is skipped where its files are absent."""
    top = recordings_folder()
    if top is None or not (top / "real" / name).exists():
        pytest.skip("the real recordings are not here: set SPACEROBOT_DATA")
    return load_study(STUDIES / name)


def arm_log(
    robot: Robot, seed: int, extra: dict[str, tuple[float, float, float]], noise: float = 0.02, seconds: float = 16.0
) -> Grid:
    """A two-joint arm on a smooth motion; torques with (Coulomb, viscous, offset) at joints, and noise [N m]."""
    rng = np.random.default_rng(seed)
    step = 0.002
    time = np.arange(0.0, seconds, step)
    waves = rng.uniform(0.15, 0.6, (2, 3)), rng.uniform(0.0, 2 * np.pi, (2, 3)), rng.uniform(0.2, 0.5, (2, 3))
    q, v, a = (np.zeros((time.size, 2)) for _ in range(3))
    for j in range(2):
        for f, phase, size in zip(*(w[j] for w in waves), strict=True):
            w = 2 * np.pi * f
            q[:, j] += size * np.sin(w * time + phase)
            v[:, j] += size * w * np.cos(w * time + phase)
            a[:, j] -= size * w * w * np.sin(w * time + phase)
    data = robot.model.createData()
    torque = np.array([pin.rnea(robot.model, data, *x) for x in zip(q, v, a, strict=True)])
    value = {}
    for j, joint in enumerate(("shoulder", "elbow")):
        coulomb, viscous, offset = extra.get(joint, (0.0, 0.0, 0.0))
        torque[:, j] += coulomb * np.sign(v[:, j]) + viscous * v[:, j] + offset + noise * rng.standard_normal(time.size)
        value[f"joint.{joint}.position"] = q[:, j] + 1e-5 * rng.standard_normal(time.size)
        value[f"joint.{joint}.torque"] = torque[:, j]
    return Grid(time, step, value, np.ones(time.size, dtype=bool))


def in_own_unit(state: Any, trials: Sequence[TrialData]) -> np.ndarray:
    """What is left over, in the unit of the readings, of all that count, shape (N,)."""
    weights = [t.blocks[0].weight.ravel() for t in trials]
    return np.concatenate([state.raw[t.id][w > 0.0] / w[w > 0.0] for t, w in zip(trials, weights, strict=True)])
