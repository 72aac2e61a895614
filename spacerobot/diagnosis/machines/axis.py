"""One joint as a mechanism: its believed spring and damper, the weight it carries, and the recorded drive if any."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from spacerobot.diagnosis.machines import torque_log
from spacerobot.diagnosis.machines.contract import FIRST_NOISE, conditions_of
from spacerobot.diagnosis.machines.doubted import doubted
from spacerobot.diagnosis.machines.joint_log import stated_friction
from spacerobot.diagnosis.machines.simulated import Build, Simulated
from spacerobot.diagnosis.machines.sizes import sizes_of
from spacerobot.diagnosis.machines.windows import Drive, band_limited, moment, refinement
from spacerobot.diagnosis.terms.candidates import stood_for
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed
from spacerobot.dynamics.inertia import joint_space_inertia
from spacerobot.dynamics.joint_kinds import joint_axis
from spacerobot.dynamics.joint_weight import weight_of
from spacerobot.effects.catalogue.preload import KERNEL as CONSTANT
from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap, Coordinate, Force, Input, Readout
from spacerobot.effects.registry import all_effects
from spacerobot.effects.weight import WEIGHT
from spacerobot.model.robot import Robot
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial

UNITS = {"mass": "kg", "damping": "N s/m", "stiffness": "N/m", "friction": "N"} | torque_log.UNITS
"""What an axis may leave unknown."""

OSCILLATIONS = 15.0
"""Length of a window of an axis on a spring, in units of the motion's own time."""

RESTART = 0.5
"""The same without a spring: a simulation under a recorded drive drifts away, and starts again."""


SWINGS = 10.0
"""The same of a joint that nothing drives and gravity alone brings back, in radians of its motion."""


ZERO = math.radians(0.5)
"""Standard deviation [rad] of where an encoder's zero is, of a joint that swings by itself and of which no study says
more: it is set by eye, or by what it hangs at, which dry friction holds off."""


def axis(
    joint: str, sensor: str, angular: bool, weight: tuple[float, float] = (0.0, 0.0), driven: bool = True
) -> Build:
    """The mechanism of one joint, by its values "joint.NAME.mass", ".stiffness", ".damping", ".friction", ".gain",
    ".bias", ".zero".

    Args:
        joint: its name.
        sensor: what verdicts call its readings.
        angular: whether it turns.
        weight: as `weight_of` has it.
        driven: whether a recorded torque acts; else the believed constant "joint.NAME.torque", if there is one.
    """
    return partial(_mechanism, joint=joint, sensor=sensor, angular=angular, weight=weight, driven=driven)


def _mechanism(
    values: Mapping[str, float],
    trial: TrialData,
    *,
    joint: str,
    sensor: str,
    angular: bool,
    weight: tuple[float, float],
    driven: bool,
) -> Mechanism:
    name = f"joint.{joint}"
    readouts = {f"{name}.{kind}": Readout(f"{name}.{kind}", kind, name) for kind in ("position", "velocity")}
    forces = []
    if f"{name}.stiffness" in values:
        forces.append(Force(f"{name}.spring", name, SPRING, (values[f"{name}.stiffness"],), role="spring"))
    if values.get(f"{name}.damping"):
        forces.append(Force(f"{name}.damper", name, DAMPER, (values[f"{name}.damping"],), role="damper"))
    constant = -torque_log.bias(values, joint) if driven else values.get(f"{name}.torque", 0.0)
    constant += values.get(f"{name}.stiffness", 0.0) * values.get(f"{name}.zero", 0.0)  # there the spring rests
    if constant:
        forces.append(Force(f"{name}.bias", name, CONSTANT, (constant,)))
    if any(weight):
        felt = (WEIGHT, _turned(weight, values.get(f"{name}.zero", 0.0))) if angular else (CONSTANT, (-weight[1],))
        forces.append(Force(f"{name}.weight", name, *felt))
    late = torque_log.late(values, joint) if driven else 0.0
    return Mechanism(
        coordinates={name: Coordinate(name, values[f"{name}.mass"], angular=angular)},
        ports={name: {name: 1.0}},
        forces=tuple(forces),
        frictions=stated_friction(values, name),
        inputs=(Input("drive", name, f"{name}.torque", torque_log.gain(values, joint)),) if driven else (),
        maps=(ChannelMap(f"{name}.torque", "delay", -late),) if late else (),
        readouts=readouts,
        sensors={sensor: tuple(c for c in readouts if c in trial.channels)},
    )


def _all_of_it(values: Mapping[str, float], name: str, own: float) -> dict[str, float]:
    """The values of a joint with its rotor in its mass, `own` where none is stated: what moves is both."""
    out = {mass_name(n): v for n, v in values.items()}
    out[f"{name}.mass"] = out.get(f"{name}.mass", own) + out.pop(f"{name}.armature", 0.0)
    return out


def _of_trial(study: Study, trial: Trial, name: str, own: float) -> dict[str, float]:
    """What a trial states for itself, as `_all_of_it` has it."""
    out = {mass_name(n): v for n, v in trial.overrides.items()}
    if out.keys() & {f"{name}.mass", f"{name}.armature"}:
        out[f"{name}.mass"] = _all_of_it(study.values(trial), name, own)[f"{name}.mass"]
        out.pop(f"{name}.armature", None)
    return out


def _sigma_of_all(sigma: Mapping[str, float], values: Mapping[str, float], name: str, own: float) -> dict[str, float]:
    """Relative deviations, by name, of a joint's values with its rotor in its mass, as `_all_of_it` has it."""
    stated = {f"{name}.mass": values.get(f"{name}.mass", own), f"{name}.armature": values.get(f"{name}.armature", 0.0)}
    parts = [(value, sigma.get(n, 0.0)) for n, value in stated.items()]
    out = {n: s for n, s in sigma.items() if n != f"{name}.armature"}
    if any(value * s for value, s in parts):
        out[f"{name}.mass"] = math.hypot(*(value * s for value, s in parts)) / sum(value for value, _ in parts)
    return out


def _between(time: np.ndarray, value: np.ndarray, factor: int) -> tuple[np.ndarray, np.ndarray]:
    """A signal at so many times its rate."""
    return band_limited(time, value, factor) if factor > 1 else (time, value)


def _turned(weight: tuple[float, float], zero: float) -> tuple[float, float]:
    """(a, b) of `weight_of` by the encoder's reading, which is `zero` [rad] where the joint's angle is nothing."""
    a, b = weight
    return a * math.cos(zero) + b * math.sin(zero), b * math.cos(zero) - a * math.sin(zero)


def mass_name(name: str) -> str:
    """What a balance calls a value: "joint.NAME.inertia" is what the joint moves, its coordinate's mass."""
    joint = name.startswith("joint.") and name.endswith(".inertia")
    return name.removesuffix("inertia") + "mass" if joint else name


def axis_model(study: Study, trials: Sequence[Trial], joint: str, robot: Robot) -> Simulated:
    """The simulated axis of a study.

    Args:
        study: its baseline and recordings.
        trials: those that log this joint's position and, where it is driven, its torque.
        joint: its name.
        robot: the study's; its inertia about the joint serves where the study states none.
    """
    name = f"joint.{joint}"
    angular = bool(joint_axis(robot.model, robot.joint_id(joint))[0])
    driven = all(f"{name}.torque" in study.recording(t) for t in trials)
    weight = weight_of(robot, study.baseline.gravity, joint)
    values = {mass_name(n): v for n, v in study.values().items() if n.startswith(f"{name}.")}
    stated_sigma = {mass_name(n): v for n, v in study.sigma.items()}
    open_ = {mass_name(n) for n in study.baseline.unknown}
    index = robot.velocity_index(joint)
    own = float(joint_space_inertia(robot, robot.configuration())[index, index])
    taken = (f"{name}.position", f"{name}.torque") if driven else (f"{name}.position",)
    doubts = doubted(study, trials, taken)
    drives, motion = {}, []
    for trial in trials:
        recording = study.recording(trial)
        time, value = recording[f"{name}.position"].good()
        force = np.zeros(0)
        if driven:
            torque = recording[f"{name}.torque"]
            factor = refinement(torque.good()[1])
            fine, drive = _between(*torque.good(), factor)
            columns = doubts.of(trial.id, torque.name, torque.good()[0])
            beside = {k: _between(torque.good()[0], column, factor)[1] for k, column in columns.items()}
            drives[trial.id], force = Drive(fine, {torque.name: drive}, beside=beside), torque.good()[1]
        motion.append((force, value, np.gradient(value, time)))
    force, place, rate = (np.concatenate([m[i] for m in motion]) for i in range(3))
    if not np.any(force):  # what it takes to move it as it moves
        force = values.get(f"{name}.mass", own) * rate**2 / max(float(np.std(place)), 1e-12)
    sizes = sizes_of(force, place, rate)
    whole, stated = [], True
    for trial in trials:
        position = study.recording(trial)[f"{name}.position"]
        time, value = position.good()
        stated = stated and position.sigma_stated
        noise = position.sigma if position.sigma_stated else FIRST_NOISE * sizes.length
        block = Block(position.stream, (position.name,), time, value[None, :], np.full((1, time.size), 1.0 / noise))
        ends = float(time[0]), float(time[-1])
        whole.append(TrialData(trial.id, study.condition(trial), _of_trial(study, trial, name, own), (block,), *ends))
    unknown = {f"{name}.{k}": sizes.of(u) for k, u in UNITS.items() if f"{name}.{k}" in open_}
    if f"{name}.mass" not in unknown:
        stated_sigma = _sigma_of_all(stated_sigma, values, name, own)
        values = _all_of_it(values, name, own)
    sigma = {n: s for n, s in stated_sigma.items() if n in values and n not in unknown}
    absolute = {n: s for n, s in study.absolute.items() if n.startswith(f"{name}.") and n not in unknown}
    values |= {n: 0.0 for n in absolute if n not in values}
    logs = (study.recording(t)[f"{name}.torque"].good()[0] for t in trials)
    late = moment(f"{name}.delay", {*absolute, *values}, (np.median(np.diff(log)) for log in logs)) if driven else {}
    if not driven and angular and any(weight) and f"{name}.zero" not in values:
        late[f"{name}.zero"] = ZERO
    values = values | dict.fromkeys(late, 0.0)
    fitted = {*unknown, *sigma, *absolute}
    sprung = f"{name}.stiffness" in values or f"{name}.stiffness" in unknown
    length = (OSCILLATIONS if sprung else RESTART) * (2.0 * math.pi if sprung else 1.0)
    made = Simulated(
        joint,
        axis(joint, whole[0].blocks[0].stream, angular, weight, driven),
        whole,
        drives,
        believed=Believed(values, sigma, {}, conditions_of(whole), unknown, absolute=absolute),
        sizes={"": sizes},
        covered=frozenset((e.name, name) for e in all_effects().values() if stood_for(e, name, fitted)),
        window=study.horizon or sizes.time * (length if driven or sprung else SWINGS * 2.0 * math.pi),
        doubted=doubts,
    )
    made.moment = late
    made.stated = frozenset(whole[0].channels if stated else ())
    return made
