"""A carriage on a rail, its place and what drives it logged: the study's head and the robot."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from spacerobot.recordings.study import Study, load_study

HEAD = """format = 1
title = "Axis"
[baseline]
robot = "axis.urdf"
base = "fixed"
joints = "free"
gravity = [0, 0, 0]
[streams.log]
time = "t"
[streams.log.channels]
q = { is = "joint.j.position" }
u = { is = "joint.j.torque", use = "input" }
"""


MASS, STEP, FINE, RIPPLE = 2.0, 0.01, 20, 0.07 / (2.0 * np.pi)


def axis_urdf(mass: float) -> str:
    """With a carriage of a mass [kg]."""
    return (
        f'<?xml version="1.0"?>\n<robot name="axis">{_link("rail", 10.0)}{_link("carriage", mass)}'
        '<joint name="j" type="prismatic"><parent link="rail"/><child link="carriage"/><axis xyz="1 0 0"/>'
        '<limit lower="-10" upper="10" effort="1e4" velocity="100"/></joint></robot>'
    )


def _link(name: str, mass: float) -> str:
    inertia = '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>'
    return f'<link name="{name}"><inertial><mass value="{mass}"/>{inertia}</inertial></link>'


def followed(
    folder: Path,
    *,
    dry: float = 0.0,
    creep: float = 0.0,
    viscous: float = 0.0,
    ripple: float = 0.0,
    late: int = 0,
    sluggish: float = 0.0,
    noise: float = 1e-5,
    apart: bool = False,
    reads: float = 1.0,
    mass: str = "",
) -> Study:
    """An axis under a controller that holds its command over a sample. Friction sticks unless it creeps.

    Args:
        folder: of the study.
        dry, viscous: friction [N], [N s/m].
        creep: speed [m/s] below which the dry one is a damper.
        ripple: amplitude [N] of a force that repeats along the way, every 7 cm.
        late: samples by which the log of the command is late; that of the place where negative.
        sluggish: time constant [s] of a filter in the log of the command.
        noise: of the log of the place [m].
        apart: whether the command's log is a stream of its own, "drive".
        reads: what the log of the command shows of one newton.
        mass: what the study says of the carriage's; that of its URDF where empty.
    """
    random = np.random.default_rng(2)
    text = HEAD.replace('joints = "free"', f'joints = "free"\njoint.j.mass = {mass}') if mass else HEAD
    if apart:
        command = 'u = { is = "joint.j.torque", use = "input" }\n'
        text = text.replace(command, f'[streams.drive]\ntime = "t"\n[streams.drive.channels]\n{command}')
    for n in range(4):
        wish = 2.0 + 0.4 * n
        place, rate, rows = 0.0, 0.0, []
        for k in range(900):
            t = k * STEP
            aim = 0.2 * np.sin(wish * t) + 0.08 * np.sin(2.7 * wish * t)
            speed = 0.2 * wish * np.cos(wish * t) + 0.08 * 2.7 * wish * np.cos(2.7 * wish * t)
            command = MASS * (400.0 * (aim - place) + 32.0 * (speed - rate))
            rows.append([t, round(place + noise * random.standard_normal(), 6), command])
            for _ in range(FINE):
                rate += STEP / FINE * (command - viscous * rate - ripple * np.sin(place / RIPPLE)) / MASS
                rubs = STEP / FINE * dry / MASS * (abs(np.tanh(rate / creep)) if creep else 1.0)
                rate = float(np.sign(rate)) * max(abs(rate) - rubs, 0.0)
                place += STEP / FINE * rate
        log = np.array(rows)
        shown = log[:, 2].copy()
        if sluggish:
            for k in range(1, shown.size):
                shown[k] = shown[k - 1] + (1.0 - np.exp(-STEP / sluggish)) * (log[k, 2] - shown[k - 1])
        if late >= 0:
            log[late:, 2] = shown[: shown.size - late]
            log = log[late:]
        else:
            log[-late:, 1] = log[:late, 1].copy()
            log = log[-late:]
        log[:, 2] *= reads
        log[:, 2] += 0.02 * random.standard_normal(len(log))
        np.savetxt(folder / f"{n}.csv", log, delimiter=",", header="t,q,u", comments="")
        text += f'[[trials]]\nid = "{n}"\ncondition = "{n}"\nlog = "{n}.csv"\n'
        text += f'drive = "{n}.csv"\n' if apart else ""
    (folder / "axis.urdf").write_text(axis_urdf(MASS))
    (folder / "study.toml").write_text(text)
    return load_study(folder)
