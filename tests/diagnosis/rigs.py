"""Small synthetic studies of the wrist rig, made by the reduced model with planted physics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study, load_study
from spacerobot.recordings.synthetic import CAMERA, FORCE_NOISE, POSITION_NOISE, SAMPLER, study_head
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.rig import rig
from spacerobot.simulation.sensors import read_channels

BELIEVED = {"wrist.mass": 0.7, "wrist.stiffness": 1020.0, "wrist.damping": 2.1, "contact.stiffness": 68000.0}


def write_study(
    folder: Path,
    *,
    planted: Sequence[tuple[str, str, Mapping[str, float]]] = (),
    truth: Mapping[str, float] | None = None,
    believed: Mapping[str, float] | None = None,
    masses: Sequence[float] = (9.0, 23.2),
    speeds: Sequence[float] = (0.06, 0.11),
    seed: int = 1,
    weighed: float = 1.0,
    tracking: float = POSITION_NOISE,
    pressed: bool = True,
    alone: Mapping[str, Sequence[tuple[str, str, Mapping[str, float]]]] | None = None,
) -> Study:
    """A study of len(masses) x len(speeds) trials with sensor noise; `truth` and `believed` set them apart.

    `weighed`: what the lab's scale shows of a target, over its mass. `tracking`: the camera's noise [m]. `pressed`:
    whether the force sensor's readings are known. `alone`: by trial, what is planted in it and in no other.
    """
    random = np.random.default_rng(seed)
    values = {**BELIEVED, "wrist.equivalent_damping": 5.0, "contact.damping": 60.0, **(truth or {})}
    stated = {**BELIEVED, "wrist.equivalent_damping": 5.0, **(believed or {})}
    text = study_head(stated, "synthetic").replace(f"sigma = {POSITION_NOISE}", f"sigma = {tracking}")
    if not pressed:
        text = text[: text.index("[streams.force]")]
    for m, mass in enumerate(masses):
        for s, speed in enumerate(speeds):
            name = f"{m}{s}"
            mechanism = rig({**values, "target.mass": mass})
            for label, where, parameters in (*planted, *(alone or {}).get(name, ())):
                mechanism = effect(label).apply(mechanism, where, parameters)
            end = 0.02 / speed + 1.4
            run = simulate(mechanism, position={"target": -0.02}, velocity={"target": speed}, end=end)
            slow, fast = np.arange(0.0, end, 1 / CAMERA), np.arange(0.0, end, 1 / SAMPLER)
            seen = read_channels(run, mechanism, ("target.x", "wrist.x"), slow)
            force = read_channels(run, mechanism, ("contact.force",), fast)["contact.force"]
            columns = [slow, *(v + tracking * random.standard_normal(slow.size) for v in seen.values())]
            np.savetxt(
                folder / f"{name}_mocap.csv", np.transpose(columns), "%.7f", ",",
                header="time_s,x_target_m,x_wrist_m", comments="",
            )  # fmt: skip
            np.savetxt(
                folder / f"{name}_force.csv",
                np.transpose([fast, force + FORCE_NOISE * random.standard_normal(fast.size)]),
                "%.6f", ",", header="time_s,f_contact_N", comments="",
            )  # fmt: skip
            text += f'[[trials]]\nid = "{name}"\ntarget.mass = {mass * weighed:.6g}\n'
            text += f'mocap = "{name}_mocap.csv"\n' + (f'force = "{name}_force.csv"\n' if pressed else "")
    (folder / "study.toml").write_text(text)
    return load_study(folder)
