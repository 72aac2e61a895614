"""A driven axis as a mechanism: one joint, its believed spring and damper, and the recorded drive."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from spacerobot.diagnosis.machines import torque_log
from spacerobot.diagnosis.machines.machine import FIRST_NOISE, conditions_of
from spacerobot.diagnosis.machines.simulated import Build, Simulated
from spacerobot.diagnosis.machines.sizes import sizes_of
from spacerobot.diagnosis.machines.windows import Drive, band_limited, refinement
from spacerobot.diagnosis.terms.candidates import stood_for
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed
from spacerobot.effects.catalogue.preload import KERNEL as CONSTANT
from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Force, Input, Readout
from spacerobot.effects.registry import all_effects
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial

UNITS = {"mass": "kg", "damping": "N s/m", "stiffness": "N/m"} | torque_log.UNITS
"""What an axis may leave unknown."""

OSCILLATIONS = 15.0
"""Length of a window of an axis on a spring, in units of the motion's own time."""

RESTART = 0.5
"""The same without a spring: a simulation under a recorded drive drifts away, and starts again."""


def axis(joint: str, sensor: str, angular: bool) -> Build:
    """The mechanism of a driven joint, by its values "joint.NAME.mass", ".stiffness", ".damping", ".gain", ".bias"."""
    name = f"joint.{joint}"

    def build(values: Mapping[str, float], trial: TrialData) -> Mechanism:
        readouts = {f"{name}.{kind}": Readout(f"{name}.{kind}", kind, name) for kind in ("position", "velocity")}
        forces = []
        if f"{name}.stiffness" in values:
            forces.append(Force(f"{name}.spring", name, SPRING, (values[f"{name}.stiffness"],), role="spring"))
        if values.get(f"{name}.damping"):
            forces.append(Force(f"{name}.damper", name, DAMPER, (values[f"{name}.damping"],), role="damper"))
        if zero := torque_log.bias(values, joint):
            forces.append(Force(f"{name}.bias", name, CONSTANT, (-zero,)))
        return Mechanism(
            coordinates={name: Coordinate(name, values[f"{name}.mass"], angular=angular)},
            ports={name: {name: 1.0}},
            forces=tuple(forces),
            inputs=(Input("drive", name, f"{name}.torque", torque_log.gain(values, joint)),),
            readouts=readouts,
            sensors={sensor: tuple(c for c in readouts if c in trial.channels)},
        )

    return build


def axis_model(study: Study, trials: Sequence[Trial], joint: str, mass: float, angular: bool) -> Simulated:
    """The simulated axis of a study.

    Args:
        study: its baseline and recordings.
        trials: those that log this joint's position and torque.
        joint: its name.
        mass: of the URDF, where the study states none [kg or kg m^2].
        angular: whether it turns.
    """
    name = f"joint.{joint}"
    recorded, drives, parts = [], {}, []
    for trial in trials:
        recording = study.recording(trial)
        position, torque = recording[f"{name}.position"], recording[f"{name}.torque"]
        time, value = position.good()
        factor = refinement(torque.good()[1])
        fine, drive = band_limited(*torque.good(), factor) if factor > 1 else torque.good()
        drives[trial.id] = Drive(fine, {f"{name}.torque": drive})
        speed = np.gradient(value, time)
        parts.append((torque.good()[1], value, speed))
        recorded.append((trial, time, value, position))
    force, place, rate = (np.concatenate([p[i] for p in parts]) for i in range(3))
    sizes = sizes_of(force, place, rate)
    whole = []
    for trial, time, value, position in recorded:
        noise = position.sigma if position.sigma_stated else FIRST_NOISE * sizes.length
        weight = np.full((1, time.size), 1.0 / noise)
        block = Block(position.stream, (f"{name}.position",), time, value[None, :], weight)
        condition, start, end = study.condition(trial), float(time[0]), float(time[-1])
        whole.append(TrialData(trial.id, condition, dict(trial.overrides), (block,), start, end))
    values = {n: v for n, v in study.values().items() if n.startswith(f"{name}.")}
    unknown = {f"{name}.{k}": sizes.of(u) for k, u in UNITS.items() if f"{name}.{k}" in study.baseline.unknown}
    if f"{name}.mass" not in unknown:
        values.setdefault(f"{name}.mass", mass)
    sigma = {n: s for n, s in study.sigma.items() if n in values and n not in unknown}
    absolute = {n: s for n, s in study.absolute.items() if n in values and n not in unknown}
    fitted = {*unknown, *sigma, *absolute}
    sprung = f"{name}.stiffness" in values or f"{name}.stiffness" in unknown
    made = Simulated(
        joint,
        axis(joint, recorded[0][3].stream, angular),
        whole,
        drives,
        believed=Believed(values, sigma, {}, conditions_of(whole), unknown, absolute=absolute),
        sizes={"": sizes},
        covered=frozenset((e.name, name) for e in all_effects().values() if stood_for(e, name, fitted)),
        window=(OSCILLATIONS if sprung else RESTART) * sizes.time * (2.0 * math.pi if sprung else 1.0),
    )
    made.stated = frozenset(whole[0].channels) if all(r[3].sigma_stated for r in recorded) else frozenset()
    return made
