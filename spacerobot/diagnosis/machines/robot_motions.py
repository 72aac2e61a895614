"""A study's robot that moves behind its wrist: its small motions about the pose of each trial."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping

import numpy as np

from spacerobot.diagnosis.machines.links import with_masses
from spacerobot.dynamics.joint_kinds import joint_axis
from spacerobot.model.robot import Robot
from spacerobot.recordings.rig_robot import study_robot
from spacerobot.recordings.study import Study
from spacerobot.simulation.parts.servo import Servo
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.servo_arm import ServoArm, servo_arm
from spacerobot.support.errors import InputError

KEPT = 256
"""Linearisations that are kept: one a pose and a set of link masses."""

Masses = tuple[tuple[str, float], ...]


class RobotMotions:
    """The robot of a study whose joints or base move.

    Attributes:
        chain: its joints from base to tip.
        angles: "joint.NAME" of those that turn.
        axes: columns approach, lateral and up, world axes, shape (3, 3).
    """

    def __init__(self, study: Study) -> None:
        baseline = study.baseline
        robot = study_robot(study, floating=True if baseline.base == "free" else None, default="pa10_wrist")
        self._base, self._joints = baseline.base, baseline.joints
        self._scene = Scene(
            robot=robot,
            base=baseline.base,
            joints=baseline.joints,
            pose=study.pose(study.trials[0]),
            approach=baseline.approach,
            servo=Servo() if baseline.joints == "servo" else None,
        )
        self._poses = {t.id: tuple(study.pose(t)) for t in study.trials}
        self._where = str(study.path)
        self.chain = robot.chain
        kinds = ((j, joint_axis(robot.model, robot.joint_id(j))[0]) for j in robot.chain)
        self.angles = frozenset(f"joint.{joint}" for joint, turns in kinds if turns)
        self.axes = self._scene.axes
        self._kept: OrderedDict[tuple[tuple[float, ...], Masses], ServoArm] = OrderedDict()

    def of(self, trial: str, masses: Mapping[str, float]) -> ServoArm:
        """The motions about the pose of a recorded trial, with these masses of links [kg].

        Raises:
            InputError: the hand cannot move along the approach there.
        """
        key = self._poses.get(trial, next(iter(self._poses.values()))), tuple(sorted(masses.items()))
        found = self._kept.get(key)
        if found is None:
            found = self._kept[key] = self._linear(*key)
            while len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        return found

    def with_masses(self, masses: Mapping[str, float]) -> Robot:
        """The robot with these masses of links [kg]."""
        robot = self._scene.prepared
        if not masses:
            return robot
        return with_masses(robot, masses, where=self._where, floating=self._base == "free" or None)

    def _linear(self, pose: tuple[float, ...], masses: Masses) -> ServoArm:
        robot = self.with_masses(dict(masses))
        found = servo_arm(
            robot, np.array(pose), self._scene.approach, self._base, {}, joints=self._joints, whole=self._base == "free"
        )
        if found is None:
            raise InputError("the hand cannot move along the approach at this pose", given=pose, where=self._where)
        return found
