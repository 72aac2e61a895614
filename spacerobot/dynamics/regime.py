"""What may move: base, joints and wrist slider, and where each sits in the velocity vector."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError

BASES = ("fixed", "free")
JOINTS = ("free", "locked", "servo")
SLIDERS = ("free", "locked")


@dataclass(frozen=True)
class Regime:
    """How the robot is held.

    Attributes:
        base: "fixed" to the world or "free" (floating).
        joints: "free" (no torque), "locked" (rigid), or "servo" (held by stiffness and damping).
        slider: "free" (the wrist spring's force is what acts on the hand) or "locked" to the hand.
    """

    base: str
    joints: str
    slider: str = "free"

    def __post_init__(self) -> None:
        for name, value, valid in (
            ("base", self.base, BASES),
            ("joints", self.joints, JOINTS),
            ("slider", self.slider, SLIDERS),
        ):
            if value not in valid:
                raise InputError(f"unknown {name} regime", given=value, valid=" or ".join(valid))


def regime_of(robot: Robot, base: str | None = None, joints: str = "free", slider: str = "free") -> Regime:
    """The regime of a robot; the base is free where the robot floats unless said otherwise.

    Raises:
        InputError: unknown word, or a free base for a robot that is bolted to the ground.
    """
    regime = Regime(base or ("free" if robot.floating else "fixed"), joints, slider)
    if regime.base == "free" and not robot.floating:
        raise InputError(
            f"{robot.name} has a fixed base, and a free one needs a spacecraft's mass and inertia",
            given="base free",
            valid="base fixed, or a robot that floats: a chaser, or float_base(robot, spacecraft)",
        )
    return regime


@dataclass(frozen=True, eq=False)
class Partition:
    """Indices into the velocity vector of `robot.model`.

    Attributes:
        base: shape (6,), the free-flyer (linear, angular; base frame), or (0,).
        arm: shape (len(chain),), the chain from base to tip.
        slider: shape (1,) or (0,), the wrist slider.
    """

    base: np.ndarray
    arm: np.ndarray
    slider: np.ndarray


def partition_of(robot: Robot) -> Partition:
    """Where base, arm and slider sit; every other joint (fingers) is neither and counts as locked."""
    base = robot.model.joints[1].idx_v + np.arange(6) if robot.floating else np.arange(0)
    slider = [] if robot.slider is None else [robot.velocity_index(robot.slider)]
    return Partition(
        base=base.astype(int),
        arm=np.array([robot.velocity_index(name) for name in robot.chain], dtype=int),
        slider=np.array(slider, dtype=int),
    )
