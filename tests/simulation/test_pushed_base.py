"""A free base in all its axes, and recorded inputs: what is pushed in is what momentum and energy gain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from spacerobot.effects.primitives import Input
from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.parts import EffectAt, Servo, Target
from spacerobot.simulation.result import multibody_ledger
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.support.errors import InputError

FLYING = Scene("chaser_pa10_wrist", joints="free", target=Target(mass=9.0, speed=0.1, gap=0.5))
AXES = {"base": 0, "base.y": 1, "base.z": 2, "base.roll": 0, "base.pitch": 1, "base.yaw": 2}


@pytest.mark.parametrize("port", AXES)
def test_a_knock_at_the_base_brings_its_own_momentum(port: str) -> None:
    """Along its axis at the base's origin, or about it; and the energy that the ledger says."""
    turns = port.endswith(("roll", "pitch", "yaw"))
    knock = EffectAt("external_impulse", port, {"impulse_Nms" if turns else "impulse_Ns": 0.4, "time_s": 0.1})
    run = simulate(FLYING.with_effects(knock), duration=0.2, must_touch=False, rate=100.0, tolerance=1e-11)
    axis, at = FLYING.axes[:, AXES[port]], int(np.searchsorted(run.time, 0.1))
    place = np.array([run[f"base.position.{a}"][at] for a in "xyz"])
    linear, angular = (m[-1] - m[0] for m in (run.linear_momentum, run.angular_momentum))
    np.testing.assert_allclose(linear, 0.0 if turns else 0.4 * axis, atol=1e-9)
    np.testing.assert_allclose(angular, 0.4 * axis if turns else 0.4 * np.cross(place, axis), atol=1e-9)
    assert run.ledger.closure < 1e-8
    assert run.ledger.work["external_impulse"][-1] > 0.0


def test_a_recorded_force_is_momentum_over_time() -> None:
    """A thrust that grows and dies away, straight between its samples, at the base; the ledger knows its work."""
    times, thrust = np.array([0.0, 0.05, 0.1, 0.3]), np.array([0.0, 2.0, 0.0, 0.0])
    mechanism = replace(FLYING.mechanism(), inputs=(Input("thrust", "base.y", "thruster", 3.0),))
    run = integrate_scene(FLYING, 0.2, mechanism=mechanism, inputs=(times, {"thruster": thrust}), tolerance=1e-11)
    gained = np.ptp(run.sample(np.array([0.0, 0.2])).momentum[:, :3], axis=0)
    np.testing.assert_allclose(gained, np.abs(3.0 * 0.1 * FLYING.axes[:, 1]), atol=1e-9)
    ledger = multibody_ledger(run)
    assert ledger.closure < 1e-8
    assert ledger.work["thrust"][-1] > 1e-5
    with pytest.raises(InputError, match="not given"):
        integrate_scene(FLYING, 0.2, mechanism=mechanism)
    with pytest.raises(InputError, match="ascending"):
        integrate_scene(FLYING, 0.2, mechanism=mechanism, inputs=(times[::-1], {"thruster": thrust}))


def test_a_servo_follows_a_recorded_reference() -> None:
    """Its stiffness times the reference and its damping times the reference's rate, as inputs at the joint."""
    scene = Scene(joints="servo", servo=Servo(4e3, 400.0), target=Target(mass=9.0, speed=0.1, gap=1.0))
    times = np.linspace(0.0, 2.0, 401)
    turn, rate = 0.05 * (1.0 - np.cos(np.pi * times)), 0.05 * np.pi * np.sin(np.pi * times)
    drives = (Input("reference", "joint.S2", "turn", 4e3), Input("its rate", "joint.S2", "rate", 400.0))
    mechanism = replace(scene.mechanism(), inputs=drives)
    run = integrate_scene(scene, 2.0, mechanism=mechanism, inputs=(times, {"turn": turn, "rate": rate}))
    taken = run.sample(np.array([0.0, 1.0, 2.0])).configuration
    at = run.assembly.model.joints[run.assembly.joints["joint.S2"]].idx_q
    np.testing.assert_allclose(taken[1:, at] - taken[0, at], [0.1, 0.0], atol=0.02)
