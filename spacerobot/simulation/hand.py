"""What the wrist feels of the arm behind it: the hand of the reduced model."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.dynamics.pose_limits import PoseLimitWarning
from spacerobot.dynamics.regime import regime_of
from spacerobot.dynamics.terms import terms_of
from spacerobot.model.describe import held_words
from spacerobot.model.robot import Robot
from spacerobot.simulation.parts import Servo
from spacerobot.simulation.servo_arm import ServoArm, servo_arm

APPROXIMATE = "an approximation, for predictions alone: what is simulated has every servo"


@dataclass(frozen=True)
class Hand:
    """One mass between the world and the wrist's guide.

    Attributes:
        mass: effective mass at the wrist mount along the approach, slider free [kg]; infinite where it is held.
        stiffness, damping: of the spring that ties it to the world [N/m, N s/m]; servo joints on a fixed base.
        note: how it was found.
        arm: the arm's motions on its servos, from which the reduced model is made; with servo joints alone.
    """

    mass: float
    stiffness: float = 0.0
    damping: float = 0.0
    note: str = ""
    arm: ServoArm | None = None


def hand_of(
    robot: Robot,
    pose: np.ndarray,
    approach: tuple[float, ...],
    base: str,
    joints: str,
    *,
    others: Mapping[str, float] | None = None,
    servo: Servo | None = None,
    wrist_stiffness: float = 0.0,
    target_mass: float = 0.0,
) -> Hand:
    """The hand of a scene: 1/(n^T J H_c^-1 J^T n) at the start pose, the slider eliminated (Schur).

    Servo joints are no single mass. Both models simulate every servo; for predictions of one number the hand has, on a
    fixed base, the mass of free joints and the spring K_tip = 1/(n^T J K^-1 J^T n), exact for slow and for fast motion,
    and on a free base the apparent mass at the contact's frequency; the note says so.

    Args:
        robot: with its wrist aimed.
        pose: shape (len(chain),) [rad or m].
        approach: unit vector, world axes.
        base, joints: the regime.
        others: positions of joints outside the chain.
        servo: what holds servo joints.
        wrist_stiffness, target_mass: for the contact's frequency [N/m, kg].
    """
    if base == "fixed" and joints == "locked":
        return Hand(math.inf, note="the arm is held")
    options = {"base": base, "direction": approach, "others": dict(others or {})}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PoseLimitWarning)  # the scene has said so
        if joints != "servo":
            found = effective_mass(robot, pose, joints=joints, **options)  # type: ignore[arg-type]
            return Hand(found.effective_mass_kg, note=f"joints {joints}, base {base}")
        assert servo is not None
        arm = servo_arm(robot, pose, approach, base, others or {})
        stiffness, damping = (np.array(c) for c in zip(*servo.per_joint(robot.chain), strict=True))
        if base == "free":
            held = effective_mass(
                robot,
                pose,
                joints="servo",
                servo=servo,
                wrist_stiffness=max(wrist_stiffness, 1e-6),
                target_mass=target_mass,
                **options,  # type: ignore[arg-type]
            )
            said = [n for n in held.notes if n != held_words(robot)]  # a scene says that by itself
            return Hand(held.effective_mass_kg, note="; ".join((*said, APPROXIMATE)), arm=arm)
        free = effective_mass(robot, pose, joints="free", **options)  # type: ignore[arg-type]
    terms = terms_of(robot, robot.configuration(pose, others=dict(others or {})), regime_of(robot, "fixed", "free"))
    row = np.array(approach) @ terms.jacobian[:3][:, terms.arm]
    if math.isinf(free.effective_mass_kg):
        return Hand(math.inf, note="servo joints: the hand cannot move along the approach")
    if (stiffness <= 0.0).any():
        return Hand(free.effective_mass_kg, note=f"a servo without stiffness: joints free; {APPROXIMATE}", arm=arm)
    give = row / stiffness
    spring = 1.0 / float(row @ give)
    return Hand(
        free.effective_mass_kg,
        spring,
        spring**2 * float(give @ (damping * give)),
        note=f"servo joints: mass of free joints on the spring of the held ones; {APPROXIMATE}",
        arm=arm,
    )
