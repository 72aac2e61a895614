"""A platform that floats on a level table while the joints of its arm follow a known motion."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np
import pinocchio as pin

from spacerobot.diagnosis.forward.base import ForwardModel, TrialOverlay, Value, channels_of, overlaid, unit_of
from spacerobot.dynamics.floating_base import BaseMotion, base_motion, floating_configuration
from spacerobot.model.robot import Robot
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.rig_robot import study_robot
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.recordings.values import yawing
from spacerobot.support.errors import InputError

TRACK = ("base.position.x", "base.position.y", "base.yaw")
SETTLE = 0.5
"""Seconds of the base's track that the start is read from, at least; all of it before the joints move, if longer."""

STILL = 1e-12
"""N or N m. A commanded thrust above it belongs to another experiment."""


@dataclass(frozen=True, eq=False)
class FloatingPlatform(ForwardModel):
    """Momentum conservation in the plane: the base moves because the joints do.

    Attributes:
        study: whose baseline it is.
        robot: on a free-flyer, its base as heavy as the study says.
        drives: joint -> the channel that it follows; the others stay at the study's pose.
    """

    kind = "a free-floating platform whose joints follow a known motion (momentum conserved)"

    study: Study
    robot: Robot
    drives: Mapping[str, str]

    @classmethod
    def applies(cls, study: Study) -> bool:
        """A free base is tracked in the plane, and some joint's motion or reference is known."""
        every = channels_of(study)
        driven = any(c.startswith("joint.") and c.endswith((".reference", ".position")) for c in every)
        return study.baseline.base == "free" and driven and set(TRACK) <= every and study.robot_source is not None

    @classmethod
    def of(cls, study: Study) -> Self:
        """The platform as believed.

        Raises:
            InputError: a joint that is not the robot's.
        """
        assert study.robot_source is not None  # applies() has seen it
        robot = study_robot(study, floating=True)
        every = channels_of(study)
        named = {c.split(".")[1]: c for c in sorted(every) if c.startswith("joint.") and c.endswith(".reference")}
        named |= {c.split(".")[1]: c for c in every if c.startswith("joint.") and c.endswith(".position")}
        for joint in named:
            robot.joint_id(joint)
        return cls(study, robot, named)

    @property
    def values(self) -> tuple[Value, ...]:
        """Mass and inertia of the platform, as stated or as the robot's own."""
        stated = yawing(self.study.values(), "platform")
        base = self.robot.model.inertias[1]
        own = {"platform.mass": base.mass, "platform.yaw_inertia": float(base.inertia[2, 2])}
        return tuple(
            Value(n, stated.get(n, own[n]), unit_of(n), "believed" if n in stated else "believed: the robot's own")
            for n in own
        )

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What was taken for granted."""
        follow = ", ".join(f"{joint} follows {channel}" for joint, channel in self.drives.items())
        return (
            f"The joints do exactly what is known of them: {follow}; cubic between samples, still outside of them.",
            "The start is the straight line through the track of the common centre of mass before the joints move; "
            "after that, linear and angular momentum stay what they are. The table is level.",
        )

    def simulate(self, trial: Trial) -> TrialOverlay:
        """One trial from the platform's own drift before the arm moves."""
        recording = self.study.recording(trial)
        for channel in TRACK:
            if channel not in recording:
                raise InputError("a trial without its base's track has no start", given=channel, where=trial.where)
        self._require_no_thrust(recording, trial)
        times = np.unique(np.concatenate([recording[c].time for c in recording if recording[c].use == "output"]))
        times = times[times >= recording["base.yaw"].time[0]]
        joints = _Joints(self.robot, self.drives, recording, self.study.pose(trial))
        motion = self._motion(trial, recording, joints, times)
        shown = self._shown(motion)
        channels = []
        for name in recording:
            series = recording[name]
            track = shown.get(name) if series.use == "output" else None
            if track is None and series.use == "output":
                track = self._marker(motion, name)
            if track is not None:
                channels.append(overlaid(series, np.interp(series.time, times, track, left=np.nan)))
        return TrialOverlay(trial.id, self.study.condition(trial), tuple(channels))

    def _motion(self, trial: Trial, recording: Recording, joints: _Joints, times: np.ndarray) -> BaseMotion:
        model = self._model(trial)
        begin = float(times[0])
        settled = max(joints.moves_at, begin + SETTLE)
        q, v = joints(begin)
        yaw, spin = _line(*recording["base.yaw"].good(), begin, settled)
        # the common centre of mass moves evenly, whichever way the platform turns meanwhile
        data = model.createData()
        ahead, left, _ = pin.centerOfMass(model, data, floating_configuration(model, pin.neutral(model)[:7], q))
        start, rate = np.transpose([_line(*_centre(recording, axis, ahead, left), begin, settled) for axis in "xy"])
        turn = pin.utils.rotate("z", yaw)
        arm = turn @ [ahead, left, 0.0]
        base = np.array([*start, 0.0, 0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)]) - [*arm, 0, 0, 0, 0]
        drift = turn.T @ (np.array([*rate, 0.0]) - np.cross([0.0, 0.0, spin], arm))
        matrix = pin.computeCentroidalMap(model, data, floating_configuration(model, base, q))
        momentum = matrix @ np.concatenate([drift, [0.0, 0.0, spin], v])
        return base_motion(model, joints, times, base=base, momentum=momentum, knots=joints.knots, tolerance=1e-8)

    def _model(self, trial: Trial) -> pin.Model:
        model = self.robot.model.copy()
        stated = yawing(self.study.values(trial), "platform")
        base = model.inertias[1]
        mass = stated.get("platform.mass", base.mass)
        inertia = base.inertia.copy()
        inertia[2, 2] = stated.get("platform.yaw_inertia", inertia[2, 2])
        lever = np.array([stated.get(f"platform.com.{a}", x) for a, x in zip("xyz", base.lever, strict=True)])
        model.inertias[1] = pin.Inertia(mass, lever, inertia)
        return model

    def _shown(self, motion: BaseMotion) -> dict[str, np.ndarray]:
        q, v = motion.configuration, motion.velocity
        yaw = np.unwrap(2.0 * np.arctan2(q[:, 5], q[:, 6]))
        turns = 2.0 * math.pi * round((self._first_yaw(motion) - yaw[0]) / (2.0 * math.pi))
        vx, vy = (np.cos(yaw) * v[:, 0] - np.sin(yaw) * v[:, 1], np.sin(yaw) * v[:, 0] + np.cos(yaw) * v[:, 1])
        return {
            "base.position.x": q[:, 0],
            "base.position.y": q[:, 1],
            "base.yaw": yaw + turns,
            "base.velocity.x": vx,
            "base.velocity.y": vy,
            "base.velocity.yaw": v[:, 5],
            "base.angular_velocity.z": v[:, 5],
        }

    def _first_yaw(self, motion: BaseMotion) -> float:
        return 2.0 * math.atan2(motion.configuration[0, 5], motion.configuration[0, 6])

    def _marker(self, motion: BaseMotion, channel: str) -> np.ndarray | None:
        """World position of a link, a joint or the tip, along the axis the channel names; None for other channels."""
        head, _, axis = channel.rpartition(".position.")
        if not head or axis not in ("x", "y", "z") or head == "base":
            return None
        frame = self.robot.tip if head == "hand" else head.removeprefix("link.")
        if not self.robot.model.existFrame(frame):
            return None
        index, model = self.robot.frame_id(frame), self.robot.model
        data = model.createData()
        place = np.empty(motion.time.size)
        for i, q in enumerate(motion.configuration):
            pin.forwardKinematics(model, data, q)
            place[i] = pin.updateFramePlacement(model, data, index).translation["xyz".index(axis)]
        return place

    def _require_no_thrust(self, recording: Recording, trial: Trial) -> None:
        for series in recording.inputs():
            if series.name.startswith(("base.force", "base.torque")) and np.abs(series.good()[1]).max() > STILL:
                raise InputError(
                    "the thrusters are on, and momentum is not conserved",
                    given=f"{series.name} up to {np.abs(series.good()[1]).max():g} {series.unit}",
                    valid="a window without thrust",
                    where=trial.where,
                )


class _Joints:
    """Joint positions and rates over time, in the model's order.

    Attributes:
        moves_at: when the first joint has left its start by a tenth of a milliradian (or millimetre) [s].
        knots: times at which the motion is not smooth.
    """

    def __init__(self, robot: Robot, drives: Mapping[str, str], recording: Recording, pose: tuple[float, ...]) -> None:
        from scipy.interpolate import CubicSpline

        self._rest = np.zeros(robot.model.nv - 6)
        if len(pose) == len(robot.chain):
            self._rest[[robot.velocity_index(j) - 6 for j in robot.chain]] = pose
        self._motions = []
        starts, ends = [], set()
        for joint, channel in drives.items():
            if channel not in recording:
                raise InputError(f"the motion of joint {joint} is not recorded", given=channel)
            time, value = recording[channel].good()
            left = np.abs(value - value[0]) > 1e-4
            starts.append(time[np.argmax(left)] if left.any() else time[-1])
            ends |= {float(time[0]), float(time[-1])}
            self._motions.append((robot.velocity_index(joint) - 6, time[0], time[-1], CubicSpline(time, value)))
        self.moves_at = float(min(starts))
        self.knots = sorted(ends)

    def __call__(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Positions and rates at `t`, shape (nv - 6,) each."""
        q, v = self._rest.copy(), np.zeros(self._rest.size)
        for i, first, last, spline in self._motions:
            q[i] = spline(min(max(t, first), last))
            if first <= t <= last:
                v[i] = spline(t, 1)
        return q, v


def _centre(recording: Recording, axis: str, ahead: float, left: float) -> tuple[np.ndarray, np.ndarray]:
    """Times and one coordinate of the point (ahead, left) of the platform, from its own track."""
    time, value = recording[f"base.position.{axis}"].good()
    yaw = np.interp(time, *recording["base.yaw"].good())
    if axis == "x":
        return time, value + np.cos(yaw) * ahead - np.sin(yaw) * left
    return time, value + np.sin(yaw) * ahead + np.cos(yaw) * left


def _line(time: np.ndarray, value: np.ndarray, begin: float, end: float) -> tuple[float, float]:
    """Value at `begin` and rate of a straight line through the readings up to `end`."""
    early = time <= end
    if early.sum() < 3:
        early = np.arange(time.size) < 3
    slope, offset = np.polyfit(time[early] - begin, value[early], 1)
    return float(offset), float(slope)
