"""Which models a study asks for: decided by its baseline and by what was logged, never by its name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.machines.axis import axis_model, mass_name
from spacerobot.diagnosis.machines.body import body_models
from spacerobot.diagnosis.machines.body_axes import axes_of
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.doubted import doubted
from spacerobot.diagnosis.machines.grid import Grid, even_grid
from spacerobot.diagnosis.machines.impacts import impact_models
from spacerobot.diagnosis.machines.joint_log import TURN
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.machines.links import robot_of
from spacerobot.diagnosis.machines.platform import platform_models
from spacerobot.diagnosis.machines.prescribed import carried
from spacerobot.diagnosis.machines.tossed import tossed_models
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.support.errors import InputError


def models_for(study: Study) -> tuple[Machine, ...]:
    """One model for each part of the study that can be told apart from the others: a joint, a body, a sensor.

    Raises:
        InputError: nothing that was recorded can be compared with the baseline.
    """
    found: list[Machine] = []
    for joints, trials in _logged(study).items():
        if len(joints) == 1 and (study.horizon or _sprung(study, joints[0]) or _idle(study, trials, joints[0])):
            found.append(axis_model(study, trials, joints[0], robot_of(study)))
        else:
            found += balances(study, trials, joints)
    tossed = tossed_models(study)
    found += tossed
    for group in ("body", "target") if not tossed else ():
        tracked = [t for t in study.trials if _tracked(study, t, group)]
        driven = [t for t in tracked if _drives(study, t, group)]
        # a body that is driven is not free where its drive was not logged
        chosen = driven or [t for t in tracked if not study.recording(t).inputs()]
        if chosen:
            found += body_models(study, chosen, group)
    found += carried(study)
    found += platform_models(study)
    found += impact_models(study)
    return tuple(found)


def some_models_for(study: Study) -> tuple[Machine, ...]:
    """As `models_for`, at least one.

    Raises:
        InputError: nothing that was recorded can be compared with the baseline.
    """
    found = models_for(study)
    if not found:
        raise InputError(
            "nothing that was recorded can be compared with this baseline",
            given=", ".join(study.channels()[:8]),
            valid="a wrist that meets a target; joints with position and torque; a body that is tracked; a free base"
            " that is tracked while nothing pushes it (its window), with its joints' positions or references",
            where=str(study.path),
        )
    return found


def _tracked(study: Study, trial: Trial, group: str) -> bool:
    recording = study.recording(trial)
    return any(a.shown(sorted(recording)) for a in axes_of(study, group, flies=True))


def _drives(study: Study, trial: Trial, group: str) -> list[str]:
    return [c for c in study.recording(trial) if c.startswith((f"{group}.force.", f"{group}.torque."))]


def _logged(study: Study) -> dict[tuple[str, ...], list[Trial]]:
    """Joints whose position is logged, and whose torque is logged or stated -> the trials that have just these."""
    groups: dict[tuple[str, ...], list[Trial]] = {}
    stated = study.values()
    for trial in study.trials:
        recording = study.recording(trial)
        names = [c.split(".")[1] for c in recording if c.startswith("joint.") and c.endswith(".position")]
        both = tuple(n for n in names if f"joint.{n}.torque" in recording or f"joint.{n}.torque" in stated)
        if both:
            groups.setdefault(both, []).append(trial)
    return groups


def _idle(study: Study, trials: Sequence[Trial], joint: str) -> bool:
    """Whether no drive of a joint was recorded: its torque is what the study states, zero for a pendulum."""
    return not any(f"joint.{joint}.torque" in study.recording(t) for t in trials)


def _sprung(study: Study, joint: str) -> bool:
    """Whether a spring holds the joint: only then can a recorded drive be followed for long without drift."""
    name = f"joint.{joint}.stiffness"
    return name in study.baseline.unknown or bool(study.value(name))


def _felt(name: str, joint: str) -> bool:
    """Whether a joint's balance hangs on a value: its own, any link's, and where any joint is."""
    return name.startswith((f"joint.{joint}.", "link.")) or name.endswith(".zero")


def balances(study: Study, trials: list[Trial], joints: tuple[str, ...]) -> list[Machine]:
    """A torque balance for each joint; of a base that floats, with what the joints make it do."""
    robot = robot_of(study, floating=True if study.baseline.base == "free" else None)
    fully = all(f"joint.{j}.velocity" in study.recording(t) for j in joints for t in trials)
    kinds = ("position", "torque", "velocity")[: 3 if fully else 2]
    idle = {j: study.values()[f"joint.{j}.torque"] for j in joints if _idle(study, trials, j)}
    unread = [f"joint.{j}.torque" for j in idle]
    channels = [c for j in joints for kind in kinds if (c := f"joint.{j}.{kind}") not in unread]
    turns = [TURN] if robot.floating and all(TURN in study.recording(t) for t in trials) else []
    grids = {
        t.id: (_stated(even_grid(study.recording(t), channels + turns), idle), study.condition(t), dict(t.overrides))
        for t in trials
    }
    first = next((j for j in joints if j not in idle), None)
    logged = None if first is None else study.recording(trials[0])
    stream, encoders = ("" if logged is None else logged[f"joint.{first}.{w}"].stream for w in ("torque", "position"))
    values = {mass_name(n): v for n, v in study.values().items() if n.startswith("joint.")}
    logs = [study.recording(t)[c] for t in trials for c in channels]
    doubts = doubted(study, trials, channels)
    noise = {s.name: s.sigma for s in logs if s.sigma_stated}
    found: list[Machine] = []
    for joint in joints:
        unknown = [mass_name(n) for n in sorted(study.baseline.unknown) if n.startswith(f"joint.{joint}.")]
        found.append(
            InverseDynamics(
                robot,
                study.baseline.gravity,
                grids,
                joints,
                compared=[joint],
                values=values,
                unknown=unknown,
                sigma={mass_name(n): v for n, v in study.sigma.items() if _felt(n, joint)},
                absolute={n: v for n, v in study.absolute.items() if _felt(n, joint)},
                sensor=stream,
                motion_sensor=encoders if encoders != stream else "",
                noise=noise,
                idle=tuple(idle),
                doubted=doubts,
            )
        )
    return found


def _stated(grid: Grid, torques: Mapping[str, float]) -> Grid:
    """The grid with torques that are stated instead of logged, by joint."""
    steady = {f"joint.{j}.torque": np.full(grid.time.size, torque) for j, torque in torques.items()}
    return replace(grid, value={**grid.value, **steady})
