"""Coulomb friction between tip and target: set-valued, in both directions across, and blind to names of axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.parts import ContactLaw, EffectAt, Servo, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate

WRIST = Wrist(stiffness=2000.0, damping=3.0)
TOLERANCES, AT = (1e-5, 1e-7, 1e-10), np.linspace(0.16, 0.25, 10)


def off_centre(mu: float, lateral: float, up: float, **more: object) -> Scene:
    target = Target(speed=0.06, contact_point=(0.12, lateral, up), inertia=(0.2, 0.3, 0.3))
    more = {"approach": (1.0, 0.0, 0.0), **more}
    return Scene(wrist=WRIST, contact=ContactLaw(damping=30.0, mu=mu), target=target, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize("mu", [0.0, 0.05, 0.6])
def test_sideways_and_upward_are_alike(mu: float) -> None:
    """A quarter turn about the approach takes one into the other."""
    side = simulate(off_centre(mu, 0.03, 0.0), duration=0.3, tolerance=1e-11)
    above = simulate(off_centre(mu, 0.0, 0.03), duration=0.3, tolerance=1e-11)
    assert side.restitution.target == pytest.approx(above.restitution.target, abs=1e-9)
    assert side["target.velocity.y"] == pytest.approx(above["target.velocity.z"], abs=1e-9)
    assert side["target.angular_velocity.z"] == pytest.approx(-above["target.angular_velocity.y"], abs=1e-9)


def test_strong_friction_sticks_and_weak_friction_slides_at_its_limit() -> None:
    for mu, sticks in ((5.0, True), (0.02, False)):
        run = integrate_scene(off_centre(mu, 0.03, 0.0), 0.05, tolerance=1e-10)
        taken = run.sample(np.linspace(0.005, 0.045, 41))
        slide, force = taken.contact[:, 3], taken.friction[:, 0]
        normal = run.contact_force(taken)
        pressed = normal > 0.0
        assert pressed.any()
        assert (np.abs(force) <= mu * normal * (1 + 1e-9) + 1e-9).all()
        if sticks:
            assert np.abs(slide[pressed]).max() < 1e-10
        else:
            assert np.abs(slide[pressed]).min() > 1e-5
            assert force[pressed] == pytest.approx(-mu * normal[pressed] * np.sign(slide[pressed]), rel=1e-9)


@pytest.mark.parametrize("force", [0.02, 0.1])
def test_friction_beside_friction_comes_to_rest_and_breaks_away_once(force: float) -> None:
    """What hardly slides points nowhere: a joint with friction of its own felt that as a force that shook it."""
    scene = Scene(
        "pa10_wrist",
        joints="servo",
        servo=Servo(1000.0, 4.0),
        approach=(1.0, 0.0, 0.0),
        gravity=(0.0, 0.0, 0.2),
        wrist=Wrist(mass=1.0, stiffness=500.0, damping=0.0),
        contact=ContactLaw(stiffness=20000.0, damping=28.0, mu=0.5),
        target=Target(mass=3.0, yaw_inertia=0.5, contact_point=(0.15, 0.0, 0.0), speed=0.0625),
        effects=(EffectAt("coulomb_friction", "joint.S1", {"force_N": force}),),
    )
    runs = {t: integrate_scene(scene, 0.4, tolerance=t) for t in (1e-6, 1e-8, 1e-10)}
    ends = {t: run.sample(np.array([0.4])).contact[0] for t, run in runs.items()}
    touches = sum(e.kind == "touch" for e in runs[1e-10].events)
    for t, run in runs.items():
        assert ends[t] == pytest.approx(ends[1e-10], abs=1e-3 * t), t
        assert len([e for e in run.events if e.kind in ("stick", "slip")]) <= 8 * touches, t


MOVING = {
    "servo": off_centre(0.3, 0.03, 0.01, joints="servo", servo=Servo(3000.0, 20.0)),
    "chaser": off_centre(0.3, 0.03, 0.01, robot="chaser_pa10_wrist", joints="free", base="free"),
}


@pytest.mark.parametrize("name", list(MOVING))
def test_what_slides_from_rest_is_as_right_as_it_was_asked_to_be(name: str) -> None:
    """It slides slowly at first, and then any push across turns it: where it goes, not only how fast, must converge."""
    slides = {t: integrate_scene(MOVING[name], 0.25, tolerance=t).sample(AT).contact[:, [3, 5]] for t in TOLERANCES}
    for t in TOLERANCES[:-1]:
        assert np.abs(slides[t] - slides[TOLERANCES[-1]]).max() < 10.0 * t * 0.06, t


def test_reduced_and_multibody_slide_alike() -> None:
    for mu in (0.05, 0.6):
        few, many = (simulate(off_centre(mu, 0.03, 0.0), backend=b, duration=0.4, tolerance=1e-11)
                     for b in ("reduced", "multibody"))  # fmt: skip
        assert few.restitution.target == pytest.approx(many.restitution.target, abs=1e-8)
        for name in ("target.x", "target.y", "target.yaw"):
            assert np.abs(few[name] - many[name]).max() < 1e-8


@pytest.mark.slow
@settings(max_examples=12, derandomize=True, deadline=None)
@given(
    mu=st.sampled_from([0.0, 0.1, 0.7]),
    lateral=st.floats(-0.05, 0.05),
    up=st.floats(-0.05, 0.05),
    spin=st.tuples(*[st.floats(-0.3, 0.3)] * 3),
    joints=st.sampled_from(["free", "locked", "servo"]),
    speed=st.floats(0.02, 0.15),
)
def test_momentum_is_kept_and_energy_accounted_for(
    mu: float, lateral: float, up: float, spin: tuple[float, float, float], joints: str, speed: float
) -> None:
    scene = off_centre(mu, lateral, up, robot="chaser_pa10_wrist", joints=joints,
                       servo=Servo(300.0, 2.0) if joints == "servo" else None)  # fmt: skip
    scene = replace(scene, target=replace(scene.target, spin=spin, speed=speed, gap=0.003))
    found = simulate(scene, duration=0.4, tolerance=1e-11, rate=200.0, must_touch=False)
    unit = scene.target.mass * (speed + 0.1 * float(np.linalg.norm(spin)))
    for momentum in (found.linear_momentum, found.angular_momentum):
        assert np.abs(momentum - momentum[0]).max() < 1e-9 * unit
    assert found.ledger.closure < 1e-8
    assert found.ledger.dissipated["contact"][-1] > -1e-9 * found.ledger.initial
