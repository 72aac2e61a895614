"""A free body as a mechanism: it slides, falls or turns, with the forces that were commanded."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from spacerobot.diagnosis.machines.body_axes import Axis, axes_of, directions_of, flies, spins_of
from spacerobot.diagnosis.machines.contract import FIRST_NOISE, conditions_of
from spacerobot.diagnosis.machines.doubted import doubted
from spacerobot.diagnosis.machines.simulated import Build, Simulated
from spacerobot.diagnosis.machines.sizes import sizes_of
from spacerobot.diagnosis.machines.windows import FOLDS, Drive, Turned, commanded, moment
from spacerobot.diagnosis.terms.candidates import stood_for
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed
from spacerobot.effects.catalogue.off_centre import TURN, levers
from spacerobot.effects.laws import DAMPER
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap, Coordinate, Field, Force, Input, Readout
from spacerobot.effects.registry import all_effects
from spacerobot.effects.sizes import Sizes
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.recordings.values import yawing

COMMAND = "command"
"""What the sensors' effects call the recorded forces: thrust that comes out weaker, later or sluggish."""

FORCES = "command.force"
"""The same without a torque that something else may give: by how much they are weaker, a larger mass would say too."""

COM = ("body.com.x", "body.com.y")
"""Where its centre of mass lies from the point that is tracked, along its own axes [m]."""

RESTART = 1.5
"""Length of a window under recorded forces, in units of the motion's own time: simulations of a free body drift."""


def body(
    axes: Sequence[Axis], pull: Mapping[str, float], sensors: Mapping[str, tuple[str, ...]], driven: Sequence[str]
) -> Build:
    """The mechanism of a free body.

    Args:
        axes: its coordinates.
        pull: gravity along those that feel it [m/s^2].
        sensors: by name, their channels.
        driven: force channels that were recorded.
    """
    return partial(_mechanism, axes=axes, pull=pull, sensors=sensors, driven=driven)


def _mechanism(
    values: Mapping[str, float],
    trial: TrialData,
    *,
    axes: Sequence[Axis],
    pull: Mapping[str, float],
    sensors: Mapping[str, tuple[str, ...]],
    driven: Sequence[str],
) -> Mechanism:
    coordinates, ports, readouts, inputs, forces = {}, {}, {}, [], []
    maps, late = [], values.get("body.delay", 0.0)
    for axis in axes:
        mass = values["body.yaw_inertia"] if axis.angular else values["body.mass"]
        coordinates[axis.name] = Coordinate(axis.name, mass, angular=axis.angular)
        ports[axis.name] = {axis.name: 1.0}
        for channel, kind in axis.shown(trial.channels):
            readouts[channel] = Readout(channel, kind, axis.name, axis.sign)
        if axis.force in driven:
            inputs.append(Input(f"drive {axis.name}", axis.name, axis.force, axis.sign))
        if axis.force in driven and late:
            maps.append(ChannelMap(axis.force, "delay", -late))
        damping = values.get("body.yaw_damping" if axis.angular else "body.damping")
        if damping:
            forces.append(Force(f"{axis.name}.damper", axis.name, DAMPER, (damping,), role="damper"))
    at = [values.get(name, 0.0) for name in COM]
    if any(at) and TURN in coordinates:
        maps += levers(readouts, *at)
    return Mechanism(
        coordinates=coordinates,
        ports=ports,
        forces=tuple(forces),
        fields=tuple(Field(n, g) for n, g in pull.items() if g and n in coordinates),
        inputs=tuple(inputs),
        maps=tuple(maps),
        readouts=readouts,
        sensors={s: tuple(c for c in names if c in readouts or c in driven) for s, names in sensors.items()},
    )


Log = tuple[np.ndarray, np.ndarray]
"""Times and values, shape (T,) each."""


def body_models(study: Study, trials: Sequence[Trial], group: str = "body") -> list[Simulated]:
    """Models of the free body of a study: one, or one a condition where the conditions are different bodies."""
    different = any(n.startswith(f"{group}.") for t in trials for n in t.overrides)
    if not different:
        return [_model(study, trials, group, group)]
    bodies: dict[str, list[Trial]] = {}
    for trial in trials:
        bodies.setdefault(study.condition(trial), []).append(trial)
    return [_model(study, own, group, name) for name, own in bodies.items()]


def _model(study: Study, trials: Sequence[Trial], group: str, name: str) -> Simulated:
    every = {c for t in trials for c in study.recording(t)}
    driven = sorted(c for c in every if c.startswith((f"{group}.force.", f"{group}.torque.")))
    free = flies(study, trials, group)
    spins = spins_of(study, trials, group) if free and not driven else []
    plain = [a for a in axes_of(study, group, free) if a.name not in {spin.name for spin in spins}]
    axes = [a for a in (*plain, *spins) if a.shown(sorted(every)) and (not driven or a.force in driven)]
    shown = [c for a in axes for c, _ in a.shown(sorted(every))]
    doubts = doubted(study, trials, {*shown, *driven})
    bodily = _bodily(study, trials, group)
    whole, drives, sizes = [], {}, _sizes(study, trials, axes, driven, group)
    for trial in trials:
        recording = study.recording(trial)
        blocks = []
        for axis in axes:
            for channel, kind in axis.shown(sorted(recording)):
                series = recording[channel]
                time, value = series.good()
                own = sizes[axis.name]
                noise = FIRST_NOISE * (own.length if kind == "position" else own.length / own.time)
                noise = series.sigma if series.sigma_stated else noise
                weight = np.full((1, time.size), 1.0 / noise)
                blocks.append(Block(series.stream, (channel,), time, value[None, :], weight))
        start, end = min(b.time[0] for b in blocks), max(b.time[-1] for b in blocks)
        overrides = yawing(trial.overrides, group, "body")
        condition = study.condition(trial)
        whole.append(TrialData(trial.id, condition, overrides, tuple(blocks), float(start), float(end)))
        if driven:
            beside = doubts.only(driven.__contains__).columns.get(trial.id, {})
            drives[trial.id] = _drive(recording, driven, bodily, beside)
    values = yawing(study.values(), group, "body")
    unknown, relative = {}, []
    for key, angular in (("body.mass", False), ("body.yaw_inertia", True)):
        stated = key in values or all(key in t.overrides for t in whole)
        if any(a.angular == angular for a in axes) and not stated:
            if driven:
                unknown[key] = next(sizes[a.name].mass for a in axes if a.angular == angular)
            else:  # without a known force only ratios to the mass can be told
                values[key] = 1.0
                relative.append(key)
    sensors: dict[str, tuple[str, ...]] = {}
    for block in whole[0].blocks:
        sensors[block.stream] = (*sensors.get(block.stream, ()), *block.channels)
    if driven:
        sensors[COMMAND] = tuple(driven)
        forces = tuple(c for c in driven if c.startswith(f"{group}.force."))
        if 0 < len(forces) < len(driven):
            sensors[FORCES] = forces
        # a zero of its own has each channel: a force's in the world is a tilt, a body's turns with it
        singly = {f"{COMMAND}{c.removeprefix(group)}": c for c in driven if c in bodily or c not in forces}
        if len(driven) > 1:
            sensors |= {name: (c,) for name, c in singly.items()}
    known = study.recording(trials[0])
    said = yawing(study.sigma, group, "body")
    sigma = {n: v for n, v in said.items() if n in ("body.mass", "body.yaw_inertia", *COM) and n not in unknown}
    beside_zero = {n: v for n, v in yawing(study.absolute, group, "body").items() if n in COM}
    values |= {n: values.get(n, 0.0) for n in beside_zero}
    logs = (study.recording(t)[c].good()[0] for t in trials for c in driven)
    late = moment("body.delay", values, (np.median(np.diff(log)) for log in logs)) if driven else {}
    values |= dict.fromkeys(late, 0.0)
    fitted = {*sigma, *beside_zero, *unknown, *relative}
    covers = {"target": "body.mass", "target.yaw": "body.yaw_inertia"}
    stand = {f"{place}.mass" for place, value in covers.items() if value in fitted}
    stand |= {"target.com"} if fitted.intersection(COM) else set()
    catalogue = all_effects().values()
    covered = {(e.name, place) for e in catalogue for place in covers if stood_for(e, place, stand)}
    covered |= {(e.name, FORCES) for e in catalogue if e.kind == "sensor" and e.name != "scale"}
    if len(driven) > 1:  # one number is no zero of a force and of a torque
        covered |= {(e.name, name) for e in catalogue for name in singly if e.kind == "sensor" and e.name != "bias"}
        covered.add(("bias", COMMAND))
    if free or _falls(study):
        covered |= {(e.name, a.name) for e in catalogue if e.carried for a in axes if not a.angular}
    made = Simulated(
        name,
        body(axes, _pull(study, free), sensors, driven),
        whole,
        drives,
        believed=Believed(values, sigma, {}, conditions_of(whole), unknown, absolute=beside_zero),
        sizes=sizes,
        window=study.horizon or _window(whole, sizes[""].time, bool(driven)),
        covered=frozenset(covered),
        doubted=doubts,
    )
    made.moment, made.flies = late, free
    made.stated = frozenset(c for c in whole[0].channels if known[c].sigma_stated)
    made.relative_to = tuple(key.replace("body", group, 1) for key in relative)
    return made


def _window(whole: Sequence[TrialData], pace: float, driven: bool) -> float:
    """Length of a window [s]: a free body's whole trial, or a part of it where there is nothing else to hold out."""
    if driven:
        return RESTART * pace
    return math.inf if len(whole) > 1 else (whole[0].end - whole[0].start) / FOLDS


def _bodily(study: Study, trials: Sequence[Trial], group: str) -> tuple[str, ...]:
    """The channels of a pair of forces that every trial has along the body's axes; none elsewhere."""
    pair = (f"{group}.force.x", f"{group}.force.y")
    told = [study.recording(t) for t in trials]
    return pair if all(c in r and r[c].frame == "body" for r in told for c in pair) else ()


def _drive(recording: Recording, driven: Sequence[str], bodily: Sequence[str], beside: Mapping[str, Log]) -> Drive:
    """The commands of a trial; those along the body's axes hold along these, which turn meanwhile."""
    given = {c: recording[c].good() for c in driven}
    if not bodily or not set(bodily) <= set(driven):
        return commanded(given, beside)
    ahead, aside = bodily
    time, angle = recording[f"{ahead.split('.')[0]}.yaw"].good()
    turned = Turned(ahead, aside, time, np.unwrap(angle))
    when = given[ahead][0]
    held = turned.by({c: given[c][1] for c in bodily}, when, -1.0)
    return commanded({**given, **{c: (when, held[c]) for c in bodily}}, beside).turning(turned)


def _pull(study: Study, free: bool) -> dict[str, float]:
    """Gravity by coordinate [m/s^2]; a body that something carries feels it along the approach alone."""
    gravity, approach = np.array(study.baseline.gravity), np.array(study.baseline.approach)
    pull = {"target": float(gravity @ approach)}
    if free:
        along, up = directions_of(study)
        pull["target.z"] = float(gravity[up]) if along != up else 0.0
    return pull


def _falls(study: Study) -> bool:
    """Whether the body moves along gravity."""
    gravity, approach = np.array(study.baseline.gravity), np.array(study.baseline.approach)
    return bool(abs(gravity @ approach) > 0.5 * np.linalg.norm(gravity) > 0.0)


def _sizes(
    study: Study, trials: Sequence[Trial], axes: Sequence[Axis], driven: Sequence[str], group: str
) -> dict[str, Sizes]:
    """By coordinate; "" for the one that moves most."""
    out: dict[str, Sizes] = {}
    for axis in axes:
        position, velocity, force = [], [], []
        for trial in trials:
            recording = study.recording(trial)
            for channel, kind in axis.shown(sorted(recording)):
                time, value = recording[channel].good()
                if kind == "position":
                    position.append(value)
                    velocity.append(np.gradient(value, time))
                else:
                    velocity.append(value)
                    position.append(np.cumsum((value - value.mean()) * np.gradient(time)))
            if axis.force in recording:
                force.append(recording[axis.force].good()[1])
        if not any(np.any(f) for f in force):  # what it takes to move it as it moves: its mass is known or one
            mass = np.mean([study.values(t).get(f"{group}.mass", 1.0) for t in trials])
            rate = float(np.std(np.concatenate(velocity)) ** 2 / np.std(np.concatenate(position)))
            force = [np.array([mass * rate])]
        out[axis.name] = sizes_of(np.concatenate(force), np.concatenate(position), np.concatenate(velocity))
    out[""] = max(out.values(), key=lambda s: s.length)
    return out
