"""A meeting with the hand of a floating chaser whose joints move: base, joints, wrist, target and force recorded."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spacerobot.proof.campaign import Belief, Campaign, Trial
from spacerobot.proof.engine.arm import CHAIN, POSE, ArmRig, Servo
from spacerobot.proof.engine.sensors import Channel, Stream
from spacerobot.proof.whole.orders import FAMILY

BENDING = ("S2", "E1", "W1")
"""Joints that the push along x bends at the arm's pose: it stands in a plane, and the others stay where they are."""

STIFFNESS, DAMPING = (2000.0, 8000.0), (3.0, 15.0)
"""Between which a servo is drawn [N m/rad, N m s/rad]."""

SERVO_SIGMA = {"stiffness": 0.02, "damping": 0.1}

TRACK, TURN, ENCODER = 1.5e-4, 1e-4, 5e-5
"""Noise of the base's position [m], of its attitude [rad] and of the encoders [rad]."""

EACH = 2
"""Trials with each target."""

SLOWER = 0.6
"""Share of the air bed's speeds: what is not held is pushed out of its pose."""


@dataclass(frozen=True)
class WholeMachine(Campaign):
    """A campaign with a chaser whose joints move.

    Attributes:
        servo: what holds the joints; None lets them go.
    """

    servo: Servo | None = None

    def rig(self, number: int) -> ArmRig:
        """See Campaign."""
        return ArmRig(self.trials[number].values, trial=number, floating=True, servo=self.servo or Servo(0.0))


def whole_machine(plain: Campaign, rng: np.random.Generator) -> WholeMachine:
    """The machine in the place of a chaser whose joints are locked.

    Args:
        plain: a chaser's campaign with nothing missing.
        rng: where everything else comes from.
    """
    held = bool(rng.random() < 0.5)
    head = {**plain.belief.head, "joints": "servo" if held else "free"}
    values: dict[str, Any] = {n: v for n, v in plain.belief.values.items() if n != "hand.mass"}
    sigma = {n: v for n, v in plain.belief.sigma.items() if n != "hand.mass"}
    built = {n: v for n, v in plain.as_built.items() if n != "hand.mass"}
    servo = None
    if held:
        stiffness, damping = float(rng.uniform(*STIFFNESS)), rng.uniform(*DAMPING, len(CHAIN))
        servo = Servo(stiffness, tuple(damping.tolist()))
        for name, own in zip(CHAIN, damping.tolist(), strict=True):
            for kind, true in (("stiffness", stiffness), ("damping", own)):
                key, spread = f"joint.{name}.{kind}", SERVO_SIGMA[kind]
                values[key] = float(f"{true * (1.0 + spread * rng.standard_normal()):.4g}")
                sigma[key], built[key] = spread, true
    mocap, force = plain.streams
    tracked = [c for c in mocap.channels if c.name != "hand.x"]
    tracked += [Channel(f"base.position.{axis}", TRACK, 1e-5) for axis in "xyz"]
    tracked += [Channel(f"base.{turn}", TURN, 1e-5) for turn in ("pitch", "yaw")]
    encoders = Stream(
        "encoders", "encoders", 500.0, tuple(Channel(f"joint.{n}.position", ENCODER, 1e-6) for n in CHAIN)
    )
    seen: dict[float, list[Trial]] = {}
    for trial in plain.trials:
        seen.setdefault(trial.overrides["target.mass"], []).append(trial)
    trials = tuple(_slower(t) for some in seen.values() for t in some[:EACH])
    return WholeMachine(
        "A chaser whose joints move meets a target",
        Belief({**head, "pose": [round(a, 6) for a in POSE]}, values, sigma, plain.belief.scatter),
        built,
        trials,
        (replace(mocap, channels=tuple(tracked)), force, encoders),
        seed=plain.seed,
        family=FAMILY,
        servo=servo,
    )


def _slower(trial: Trial) -> Trial:
    """With a slower target, which arrives later."""
    later = -trial.position["target"] / trial.velocity["target"] * (1.0 / SLOWER - 1.0)
    velocity = {n: SLOWER * v for n, v in trial.velocity.items()}
    return replace(trial, velocity=velocity, duration=round(trial.duration + later, 2))
