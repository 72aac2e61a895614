"""Recordings of a rig that nobody owns: the reduced model with planted physics, through sensors with noise.

For trying out what a set of trials can tell before recording it, and for teaching.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study, load_study
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.rig import rig
from spacerobot.simulation.sensors import read_channels
from spacerobot.support.errors import InputError
from spacerobot.support.files import write_text

BELIEVED: Mapping[str, float] = {
    "wrist.mass": 0.7,
    "wrist.stiffness": 530.0,
    "wrist.damping": 1.4,
    "wrist.equivalent_damping": 9.69,
    "contact.stiffness": 68000.0,
}
"""What the study says of the rig; the rig is so, but for what is planted."""

POSITION_NOISE = 1.5e-4
"""Of a marker [m]."""

FORCE_NOISE = 0.25
"""Of the force sensor [N]."""

CAMERA, SAMPLER = 120.0, 1000.0
"""Readings of markers and force a second."""

START = 0.02
"""The target begins so far from touching [m]."""

_STUDY = """\
format = 1
title = "{title}"

[baseline]
robot = "pa10_wrist"
base = "fixed"
joints = "locked"
approach = [1, 0, 0]
gravity = [0, 0, 0]
{values}
[baseline.sigma]
"wrist.stiffness" = 0.01
"wrist.mass" = 0.01
"wrist.equivalent_damping" = 0.15
"contact.stiffness" = 0.03
"target.mass" = 0.002

[streams.mocap]
time = "time_s"
[streams.mocap.channels]
x_target_m = {{ is = "target.x", sigma = {position} }}
x_wrist_m = {{ is = "wrist.x", sigma = {position} }}

[streams.force]
time = "time_s"
[streams.force.channels]
f_contact_N = {{ is = "contact.force", sigma = {force} }}
"""


def synthetic_study(
    folder: Path,
    hits: Sequence[tuple[float, float]],
    planted: Sequence[tuple[str, str, Mapping[str, float]]] = (),
    *,
    title: str = "synthetic hits",
    after: float = 1.5,
    seed: int = 0,
) -> Study:
    """Write a study of hits on a held wrist, one trial for each.

    Args:
        folder: where to; empty, or made.
        hits: (mass of the target [kg], speed [m/s]) of each trial.
        planted: (effect, where, parameters) that the rig has and the study's baseline lacks.
        title: of the study.
        after: how long a trial goes on after the first touch [s].
        seed: of the sensors' noise.

    Raises:
        InputError: the folder holds something, or a mass or speed is not positive.
        NotFoundError: no such effect or place.
    """
    if not hits or min(min(mass, speed) for mass, speed in hits) <= 0.0:
        raise InputError("hits need a positive mass and speed", given=list(hits))
    folder = Path(folder)
    if folder.exists() and any(folder.iterdir()):
        raise InputError("the folder is not empty", given=str(folder))
    random = np.random.default_rng(seed)
    text = study_head(BELIEVED, title)
    for k, (mass, speed) in enumerate(hits):
        mechanism = rig({**BELIEVED, "contact.damping": 40.0, "target.mass": mass})
        for name, where, parameters in planted:
            mechanism = effect(name).apply(mechanism, where, parameters)
        end = START / speed + after
        run = simulate(mechanism, position={"target": -START}, velocity={"target": speed}, end=end)
        slow, fast = np.arange(0.0, end, 1.0 / CAMERA), np.arange(0.0, end, 1.0 / SAMPLER)
        seen = read_channels(run, mechanism, ("target.x", "wrist.x"), slow)
        seen = {c: v + POSITION_NOISE * random.standard_normal(slow.size) for c, v in seen.items()}
        force = read_channels(run, mechanism, ("contact.force",), fast)["contact.force"]
        force = force + FORCE_NOISE * random.standard_normal(fast.size)
        label = f"{k + 1:02d}"
        mocap = {"time_s": slow, "x_target_m": seen["target.x"], "x_wrist_m": seen["wrist.x"]}
        write_text(folder / f"{label}_mocap.csv", _csv(mocap))
        write_text(folder / f"{label}_force.csv", _csv({"time_s": fast, "f_contact_N": force}))
        text += f'\n[[trials]]\nid = "{label}"\ntarget.mass = {mass!r}\n'
        text += (
            f'condition = "{mass:g} kg at {speed:g} m/s"\nmocap = "{label}_mocap.csv"\nforce = "{label}_force.csv"\n'
        )
    write_text(folder / "study.toml", text)
    return load_study(folder)


def study_head(believed: Mapping[str, float], title: str) -> str:
    """A study file but for its trials: the rig as believed, by dotted name, and the sensors of `synthetic_study`."""
    return _STUDY.format(title=title, values=_tables(believed), position=POSITION_NOISE, force=FORCE_NOISE)


def _tables(believed: Mapping[str, float]) -> str:
    groups: dict[str, list[str]] = {}
    for name, value in believed.items():
        group, key = name.split(".")
        groups.setdefault(group, []).append(f"{key} = {value!r}")
    return "".join(f"\n[baseline.{group}]\n" + "\n".join(lines) + "\n" for group, lines in groups.items())


def _csv(columns: Mapping[str, np.ndarray]) -> str:
    rows = np.transpose(list(columns.values()))
    return "\n".join([",".join(columns), *(",".join(f"{x:.7g}" for x in row) for row in rows)]) + "\n"
