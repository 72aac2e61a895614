"""Arms on servos and under gravity: what the reduced model holds, what it refuses, and where servos start."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from spacerobot.simulation.parts import ContactLaw, EffectAt, Servo, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.simulation.unfinished import remedy
from spacerobot.support.errors import InputError

PLAIN = Scene(
    wrist=Wrist(stiffness=2000.0, damping=3.0),
    contact=ContactLaw(damping=30.0, mu=0.3),
    target=Target(speed=0.06, contact_point=(0.12, 0.03), yaw_inertia=0.3),
    duration=0.3,
)

REFUSED = {
    "falls": {"joints": "free", "gravity": (0.0, 0.0, -9.8)},
    "a servo that holds nothing": {
        "joints": "servo",
        "servo": Servo([0.0] + [1e3] * 6, 1.0),
        "gravity": (0.0, 0.0, -9.8),
    },
    "friction moves the hand": {"joints": "free"},
    "pitches": {"target": Target(contact_point=(0.1, 0.0, 0.02))},
    "leaves the plane": {"target": Target(spin=(0.1, 0.0, 0.0))},
    "wobble": {
        "target": replace(PLAIN.target, yaw_inertia=None, inertia=((0.3, 0, 0.05), (0, 0.3, 0), (0.05, 0, 0.3)))
    },
    "out of its plane": {"gravity": (0.0, 0.0, -0.1)},
}


@pytest.mark.parametrize("name", list(REFUSED))
def test_what_the_reduced_model_does_not_hold_it_refuses(name: str) -> None:
    with pytest.raises(InputError, match="the reduced model does not hold this") as refused:
        simulate(replace(PLAIN, **REFUSED[name]), backend="reduced")
    assert "multibody" in str(refused.value)


@pytest.mark.parametrize("base", ["fixed", "free"])
@pytest.mark.parametrize(("stiffness", "damping"), [(1e4, 10.0), (1e3, 5.0), (300.0, 2.0)])
def test_servos_are_the_same_in_both_at_small_motion(base: str, stiffness: float, damping: float) -> None:
    """The slower the hit, the smaller the motion, and the difference is of second order."""
    found = {}
    for speed in (0.02, 0.005):
        scene = Scene(
            "pa10_wrist" if base == "fixed" else "chaser_pa10_wrist",
            joints="servo",
            servo=Servo(stiffness, damping),
            wrist=Wrist(stiffness=1020.0, damping=2.0),
            target=Target(speed=speed),
            duration=1.2,
        )
        few, many = (simulate(scene, backend=b) for b in ("reduced", "multibody"))
        found[speed] = abs(few.restitution.target - many.restitution.target)
        for joint in ("S2", "E1"):
            moved = float(np.ptp(many[f"joint.{joint}.position"]))
            gone = np.abs(few[f"joint.{joint}.position"] - many[f"joint.{joint}.position"]).max()
            assert gone < 0.1 * moved
        if base == "free":
            assert np.abs(few["momentum.x"] - many["momentum.x"]).max() < 1e-6
    assert found[0.005] < 0.01
    assert found[0.005] < 0.5 * found[0.02] + 1e-6


@pytest.mark.parametrize("gravity", [(0.0, 0.0, -9.80665), (3.0, 0.0, -2.0)])
def test_servos_stand_still_under_gravity_until_they_are_touched(gravity: tuple[float, float, float]) -> None:
    """Payload and all; the wrist starts where its own weight puts it."""
    wrist = Wrist(stiffness=1020.0, damping=2.0, deflection=1.7 * gravity[0] / 1020.0)
    scene = Scene(
        approach=(1.0, 0.0, 0.0),
        joints="servo",
        servo=Servo(1e3, 5.0),
        gravity=gravity,
        wrist=wrist,
        target=Target(gap=0.05, speed=0.2),
    )
    scene = scene.with_effects(EffectAt("payload", "wrist", {"mass_kg": 1.0}))
    found = simulate(scene, duration=0.3, tolerance=1e-11)
    before = found.time < found.restitution.first_touch - 1e-3
    assert before.sum() > 50
    for name in scene.prepared.chain:
        assert np.ptp(found[f"joint.{name}.position"][before]) < 1e-9
    assert np.abs(found["joint.S2.torque"][0]) > 1.0, "and they do carry it"


def test_a_stiff_servo_that_fails_is_told_what_helps() -> None:
    def advice(stiffness: float, damping: float) -> str:
        scene = Scene(joints="servo", servo=Servo(stiffness, damping))
        return remedy(scene.mechanism("multibody"), lambda port: 10.0)

    assert "softer servos" in advice(1e9, 1.0)
    assert "less servo damping" in advice(1e3, 1e6)
    assert "softer contact" in advice(1e3, 1.0)
    assert "more damping" not in advice(1e9, 1.0) + advice(1e3, 1e6)


def test_a_free_chaser_that_falls_sideways_is_refused_and_one_that_falls_along_is_not() -> None:
    chaser = Scene("chaser_pa10_wrist", approach=(1.0, 0.0, 0.0), target=Target(speed=0.06), duration=0.1)
    with pytest.raises(InputError, match="falls sideways"):
        simulate(replace(chaser, base="free", gravity=(0.0, -0.1, 0.0)), backend="reduced")
    simulate(replace(chaser, base="free", gravity=(0.1, 0.0, 0.0)), backend="reduced")
