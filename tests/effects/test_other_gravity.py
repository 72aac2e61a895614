"""A pull beside gravity is another gravity, an encoder's zero another reading; both as rigid-body torques have them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.model.library import load
from spacerobot.simulation.parts import EffectAt, Servo, Target
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.support.errors import NotFoundError

HELD = Scene(
    "pa10_wrist",
    joints="servo",
    servo=Servo(3000.0, 30.0),
    target=Target(speed=0.05),
    gravity=(0.0, 0.0, -0.4),
    approach=(1.0, 0.0, 0.0),
    duration=0.2,
)
CHASER = Scene("chaser_pa10_wrist", base="free", joints="free", target=Target(speed=0.05), duration=0.2)


@pytest.mark.filterwarnings("ignore::spacerobot.simulation.room.StartWarning")
@pytest.mark.parametrize("scene", [HELD, CHASER], ids=["held", "chaser"])
def test_a_pull_is_another_gravity(scene: Scene) -> None:
    """Another route to the same motion: the scene in that gravity. Without it the motion is another, but for the joints
    of what falls freely."""
    pull = {"pull_m_s2": 0.05, "x": 0.6, "y": 0.0, "z": -0.8}
    x, y, z = (g + 0.05 * d for g, d in zip(scene.gravity, (0.6, 0.0, -0.8), strict=True))
    scenes = scene, scene.with_effects(EffectAt("other_gravity", "base", pull)), replace(scene, gravity=(x, y, z))
    plain, ours, theirs = (simulate(one, tolerance=1e-9, must_touch=False) for one in scenes)
    for channel in ("target.x", "joint.W1.position"):
        moved = np.ptp(plain[channel])
        assert np.abs(ours[channel] - theirs[channel]).max() < 1e-6 * moved
        other = np.abs(plain[channel] - theirs[channel]).max()
        falls = scene is CHASER and channel.startswith("joint")
        assert other < 1e-9 * moved if falls else other > 1e-4 * moved


def test_bodies_that_feel_gravity_along_their_path_alone_have_no_place_for_it() -> None:
    with pytest.raises(NotFoundError, match="place for other_gravity"):
        value = {"pull_m_s2": 0.05, "x": 1.0, "y": 0.0, "z": 0.0}
        Scene("pa10_wrist").with_effects(EffectAt("other_gravity", "base", value)).mechanism("reduced")


@pytest.mark.filterwarnings("ignore::spacerobot.simulation.room.StartWarning")
def test_a_zero_is_read_and_moves_nothing() -> None:
    off = CHASER.with_effects(EffectAt("encoder_zero", "joint.E1", {"zero_m": 0.03}))
    plain, shown = (simulate(one, tolerance=1e-9, must_touch=False) for one in (CHASER, off))
    assert np.allclose(shown.measured["joint.E1.position"] - plain.measured["joint.E1.position"], 0.03, atol=1e-12)
    for channel in ("target.x", "joint.W1.position"):
        assert np.array_equal(shown[channel], plain[channel])


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from(["pa10", "panda", "ur5"]))
def test_torques_rise_with_a_pull_and_with_a_zero_as_they_are_said_to(seed: int, name: str) -> None:
    """A pull exactly, for weight is in proportion to gravity; a zero to first order, to either side of nothing."""
    robot, rng = load(name), np.random.default_rng(seed)
    joints, gravity, pull = list(robot.chain), np.array([0.0, 0.0, -9.81]), rng.normal(0.0, 1.0, 3)
    q, v, a = rng.normal(0.0, 1.0, (3, 4, len(joints)))
    arm, pulled = Rigid(robot, gravity, joints), Rigid(robot, gravity + pull, joints)
    size = np.abs(arm.torque(q, v, a)).max()
    more = pulled.torque(q, v, a) - arm.torque(q, v, a)
    assert np.abs(arm.by_gravity(q) @ pull - more).max() < 1e-12 * size
    zeros = 1e-5 * rng.normal(0.0, 1.0, len(joints))
    off = 0.5 * (arm.torque(q - zeros, v, a) - arm.torque(q + zeros, v, a))
    assert np.abs(arm.by_zero(q, v, a) @ zeros - off).max() < 1e-6 * np.abs(off).max() + 1e-10 * size


def test_a_zero_in_an_arm_that_floats_is_told_by_differences() -> None:
    """The base moves along with the joints: what it does depends on their places, too."""
    robot, rng = load("chaser_pa10_wrist"), np.random.default_rng(0)
    joints = list(robot.chain)
    arm = Rigid(robot, (0.0, 0.0, 0.0), joints)
    q, v, a = rng.normal(0.0, 0.5, (3, 3, len(joints)))
    zeros = 1e-5 * rng.normal(0.0, 1.0, len(joints))
    off = 0.5 * (arm.torque(q - zeros, v, a) - arm.torque(q + zeros, v, a))
    assert np.allclose(arm.by_zero(q, v, a) @ zeros, off, rtol=1e-4, atol=1e-9)
    still = pin.Model(arm.model)
    assert still.nv == len(joints) + 7  # six of the base, one of the wrist
