"""One joint driven by a recorded force: a motor axis, or an electronic oscillator that stands for one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Self

import numpy as np

from spacerobot.diagnosis.forward.base import (
    ChannelOverlay,
    ForwardModel,
    TrialOverlay,
    Value,
    channels_of,
    overlaid,
)
from spacerobot.diagnosis.forward.momentum_balance import balance
from spacerobot.diagnosis.machines import torque_log
from spacerobot.diagnosis.machines.axis import axis
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.mechanism import Mechanism
from spacerobot.recordings.rig_robot import sliding_joints, study_robot
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.sensors import read_channels
from spacerobot.support.errors import InputError

RESTART = 0.5
"""Seconds after which an axis that no spring holds starts anew: it integrates its errors twice."""

START_SPAN = 0.03
"""Seconds of the track that a start without a spring is read from."""

LAWS = ("mass", "damping", "stiffness")


@dataclass(frozen=True, eq=False)
class DrivenAxis(ForwardModel):
    """m a + c v + k x = recorded force, on one joint.

    Attributes:
        study: whose baseline it is.
        joint: the joint's name.
        stated: mass, damping and stiffness as believed, SI.
        found: those of them that the study calls unknown, from the momentum balance of all trials.
        angular: whether the joint turns.
    """

    kind = "one joint driven by its recorded force (reduced model)"

    study: Study
    joint: str
    stated: Mapping[str, float]
    found: Mapping[str, float]
    angular: bool

    @classmethod
    def applies(cls, study: Study) -> bool:
        """Exactly one joint has a recorded drive, and its position is recorded."""
        return study.baseline.base == "fixed" and _driven(study) is not None

    @classmethod
    def of(cls, study: Study) -> Self:
        """The axis as believed; what is unknown from the recordings.

        Raises:
            InputError: the recordings do not determine what is unknown.
        """
        joint = _driven(study)
        assert joint is not None  # applies() has seen it
        values, prefix = study.values(), f"joint.{joint}."
        unknown = {n.removeprefix(prefix) for n in study.baseline.unknown if n.startswith(prefix)}
        stated = {law: values[prefix + law] for law in LAWS if prefix + law in values}
        if "mass" not in stated and prefix + "inertia" in values:
            stated["mass"] = values[prefix + "inertia"]
        if "mass" not in stated and not unknown & {"mass", "inertia"}:
            stated["mass"] = _urdf_mass(study, joint)
        if "mass" in stated:
            stated["mass"] += values.get(prefix + "armature", 0.0)
        wanted = tuple(n for n in LAWS if n not in stated and (n == "mass" or n in unknown))
        tracks = [study.recording(t) for t in study.trials]
        angular = tracks[0][f"joint.{joint}.position"].unit == "rad" and joint not in sliding_joints(study)
        return cls(
            study,
            joint,
            stated,
            balance(tracks, joint, stated, wanted, partial(torque_log.torque, values, joint)),
            angular,
        )

    @property
    def values(self) -> tuple[Value, ...]:
        """Mass, damping, stiffness."""
        units = ("kg m2", "Nm s/rad", "Nm/rad") if self.angular else ("kg", "N s/m", "N/m")
        source = "unknown to the study: from the momentum balance of all trials"
        both = [(self.stated, "believed"), (self.found, source)]
        return tuple(
            Value(f"joint.{self.joint}.{law}", table[law], unit, said)
            for law, unit in zip(LAWS, units, strict=True)
            for table, said in both
            if law in table
        )

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What was taken for granted."""
        drive = f"The drive is {self._channel('torque')} as recorded, linear between its samples."
        if self._springy:
            return (drive, "Each trial starts from its first readings and runs through.")
        return (
            drive,
            f"No spring holds the axis, so any error of the force is integrated twice: the simulation starts anew from "
            f"the recording every {RESTART:g} s. A residual is what {RESTART:g} s at most can build up.",
        )

    def simulate(self, trial: Trial) -> TrialOverlay:
        """One trial, in windows where nothing brings the axis back."""
        recording = self.study.recording(trial)
        position, drive = recording[self._channel("position")], recording[self._channel("torque")]
        own = {n.rsplit(".", 1)[1]: v for n, v in trial.overrides.items() if n.startswith(f"joint.{self.joint}.")}
        mechanism = self.mechanism({**self.stated, **self.found, **own})
        force_time, force = drive.good()
        said = self.study.values(trial)
        inputs = (force_time, {drive.name: torque_log.torque(said, self.joint, force)})
        shown = [name for name in mechanism.readouts if name in recording]
        simulated = {name: np.full(len(recording[name]), np.nan) for name in shown}
        starts = self._starts(position.time)
        for begin, end in zip(starts, np.append(starts[1:], position.time[-1]), strict=True):
            x, v = start_state(*position.good(), begin, 0.0 if self._springy else START_SPAN)
            run = simulate(
                mechanism,
                position={self._port: x},
                velocity={self._port: v},
                start=begin,
                end=end,
                inputs=inputs,
                tolerance=1e-6,
                max_step=0.01,
            )
            for name in shown:
                time = recording[name].time
                last = time <= end if end == position.time[-1] else time < end
                inside = (time >= begin) & last
                simulated[name][inside] = read_channels(run, mechanism, [name], time[inside])[name]
        restarts = None if self._springy else starts
        channels: list[ChannelOverlay] = [
            overlaid(recording[name], simulated[name], restarts=restarts) for name in shown
        ]
        return TrialOverlay(trial.id, self.study.condition(trial), tuple(channels))

    def mechanism(self, values: Mapping[str, float]) -> Mechanism:
        """The axis with these values of mass, damping and stiffness."""
        named = {f"{self._port}.{law}": value for law, value in values.items()}
        return axis(self.joint, "", self.angular)(named, TrialData("", "", {}, (), 0.0, 0.0))

    @property
    def _springy(self) -> bool:
        return {**self.stated, **self.found}.get("stiffness", 0.0) > 0.0

    @property
    def _port(self) -> str:
        return f"joint.{self.joint}"

    def _channel(self, kind: str) -> str:
        return f"joint.{self.joint}.{kind}"

    def _starts(self, time: np.ndarray) -> np.ndarray:
        if self._springy:
            return time[:1]
        count = max(1, int(np.ceil((time[-1] - time[0]) / RESTART - 0.1)))
        return np.asarray(time[0] + RESTART * np.arange(count))


def start_state(time: np.ndarray, value: np.ndarray, start: float, span: float) -> tuple[float, float]:
    """Value and rate at `start` from a cubic through the readings within half a `span` of it, five at least."""
    near = np.abs(time - start) <= 0.5 * span
    if near.sum() < 5:
        nearest = np.argsort(np.abs(time - start), kind="stable")[:5]
        near = np.zeros(time.size, dtype=bool)
        near[nearest] = True
    order = min(3, int(near.sum()) - 1)
    if order < 1:
        return float(value[near][0]), 0.0
    fit = np.polyfit(time[near] - start, value[near], order)
    return float(fit[-1]), float(fit[-2])


def _driven(study: Study) -> str | None:
    """The one joint with a recorded drive and position; None where there is none, or several."""
    inputs, every = channels_of(study, "input"), channels_of(study)
    names = {c.split(".")[1] for c in inputs if c.startswith("joint.") and c.endswith(".torque")}
    recorded = {n for n in names if f"joint.{n}.position" in every}
    return recorded.pop() if len(recorded) == len(names) == 1 else None


def _urdf_mass(study: Study, joint: str) -> float:
    """What moves with the joint, from the study's robot [kg or kg m^2]."""
    if study.robot_source is None:
        raise InputError(
            "the moving mass is not known",
            valid=f'joint.{joint}.mass = 50.0, or "unknown", or a robot',
            where=str(study.path),
        )
    import pinocchio as pin

    robot = study_robot(study)
    inertia = pin.crba(robot.model, robot.model.createData(), pin.neutral(robot.model))
    index = robot.model.joints[robot.joint_id(joint)].idx_v
    return float(inertia[index, index])
