"""Small studies written to disk for the overlay's tests, their recordings made by arithmetic of its own."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

DATA = Path(os.environ.get("SPACEROBOT_DATA", Path(__file__).resolve().parents[3] / "shared" / "recordings"))

CAMPAIGNS = sorted(p.parent.name for p in DATA.glob("*/study.toml"))

needs_campaigns = pytest.mark.skipif(not CAMPAIGNS, reason="the campaigns are not here (SPACEROBOT_DATA)")


def needs_real(name: str) -> pytest.MarkDecorator:
    there = (DATA / "real" / name).is_dir()
    return pytest.mark.skipif(not there, reason=f"real/{name} is not here (SPACEROBOT_DATA)")


def write_csv(path: Path, columns: Mapping[str, np.ndarray]) -> None:
    rows = np.column_stack(list(columns.values()))
    lines = [",".join(columns), *(",".join(f"{v:.12g}" for v in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def axis_study(
    folder: Path,
    *,
    mass: float = 3.0,
    damping: float = 4.0,
    stiffness: float = 0.0,
    baseline: str = "mass = 3.0\ndamping = 4.0",
    sign: float = 1.0,
    seconds: float = 6.0,
) -> Path:
    """A driven axis; m a + c v + k x = u with u of three sines, solved in closed form, started at rest's steady state.

    The steady response alone is recorded, so the start is not at rest: a simulation has to find it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    time = np.arange(0.0, seconds, 1e-3)
    force, position = np.zeros_like(time), np.zeros_like(time)
    for amplitude, hertz, phase in ((6.0, 0.7, 0.2), (5.0, 1.9, 1.0), (4.0, 4.3, 2.5)):
        w = 2.0 * np.pi * hertz
        force += amplitude * np.cos(w * time + phase)
        position += np.real(amplitude * np.exp(1j * (w * time + phase)) / (stiffness - mass * w**2 + 1j * damping * w))
    write_csv(folder / "log.csv", {"t": time, "u": sign * force, "x": position})
    robot = (
        '<robot name="axis"><link name="rail"/><link name="cart"><inertial><mass value="7"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="slide" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>'
        '<limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>'
    )
    (folder / "axis.urdf").write_text(robot)
    (folder / "study.toml").write_text(
        f"""format = 1
title = "a cart"
[baseline]
robot = "axis.urdf"
base = "fixed"
joints = "free"
[baseline.joint.slide]
{baseline}
[streams.log]
time = "t"
[streams.log.channels]
u = {{ is = "joint.slide.torque", unit = "N", use = "input" }}
x = {{ is = "joint.slide.position", unit = "m", sigma = 1e-5 }}
[[trials]]
id = "a"
log = "log.csv"
"""
    )
    return folder
