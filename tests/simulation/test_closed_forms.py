"""Closed forms of contact, each in a scene where it is exact, on both backends; and the limits that lead to others.

Contact laws: a wrist without a spring is a free mass of 0.7 kg, so that the pair collides with its reduced mass.
Wrist forms: the target held to the slider is a heavier slider, here one that is set moving by an impulse.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from spacerobot.effects.primitives import Impulse
from spacerobot.model.spacecraft import SpacecraftSpec
from spacerobot.simulation.multibody.run import MultibodyRun, integrate_scene
from spacerobot.simulation.parts import ContactLaw, Target, Wrist
from spacerobot.simulation.reduced.run import ReducedRun
from spacerobot.simulation.reduced.run import simulate as simulate_reduced
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.theory import coulomb_slider, hunt_crossley, kelvin_voigt, power_law

V0 = 0.07
BACKENDS = ("multibody", "reduced")
PAIR = 1.0 / (1.0 / 0.7 + 1.0 / 9.0)
STIFFNESS = 68000.0


def collide(contact: ContactLaw, backend: str, duration: float, rate: float = 2e5):
    scene = Scene(wrist=Wrist(stiffness=0.0), contact=contact, target=Target(speed=V0, gap=1e-4), duration=duration)
    return simulate(scene, backend=backend, tolerance=1e-12, rate=rate)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("zeta", "bilateral"),
    [*((z, False) for z in (0.0, 0.1, 0.45, 0.7, 1.0, 1.6)), *((z, True) for z in (0.0, 0.1, 0.45, 0.7))],
)
def test_spring_and_dashpot(backend: str, zeta: float, bilateral: bool) -> None:
    damping = 2.0 * zeta * math.sqrt(STIFFNESS * PAIR)
    end = "displacement_zero" if bilateral else "force_zero"
    time = kelvin_voigt.contact_time(PAIR, STIFFNESS, damping, end)
    found = collide(ContactLaw(STIFFNESS, damping, bilateral=bilateral), backend, 1e-4 / V0 + 1.5 * time)
    assert found.restitution.contact_time == pytest.approx(time, rel=1e-9)
    expected = kelvin_voigt.restitution(PAIR, STIFFNESS, damping, end)
    assert found.restitution.point == pytest.approx(expected, rel=1e-8)
    deepest = kelvin_voigt.peak_deflection(PAIR, STIFFNESS, damping, V0)
    strongest = kelvin_voigt.peak_force(PAIR, STIFFNESS, damping, V0)
    assert found["contact.penetration"].max() == pytest.approx(deepest, rel=1e-6)
    if zeta < 0.5:
        assert found["contact.force"].max() == pytest.approx(strongest, rel=1e-6)
    else:  # at the very touch, which falls between two samples
        assert found["contact.force"].max() == pytest.approx(strongest, rel=2e-2)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("exponent", [1.5, 2.0])
def test_hunt_and_crossley(backend: str, exponent: float) -> None:
    for chi in (0.01, 0.5, 8.0, 60.0):
        law = ContactLaw(STIFFNESS, law="hunt_crossley", exponent=exponent, chi_over_k=chi)
        found = collide(law, backend, 0.05, rate=1e3)
        assert found.restitution.point == pytest.approx(hunt_crossley.restitution(chi, 1.0, V0), rel=1e-6)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.5])
def test_power_law(backend: str, exponent: float) -> None:
    stiffness = STIFFNESS * 1e-3 ** (1.0 - exponent)
    found = collide(ContactLaw(STIFFNESS, law="hertz", exponent=exponent), backend, 0.05)
    assert found.restitution.point == pytest.approx(1.0, abs=1e-9)
    time = power_law.contact_time(PAIR, stiffness, V0, exponent)
    assert found.restitution.contact_time == pytest.approx(time, rel=1e-6)
    deepest = power_law.peak_deflection(PAIR, stiffness, V0, exponent)
    assert found["contact.penetration"].max() == pytest.approx(deepest, rel=1e-6)


def slide(wrist: Wrist, backend: str, end: float) -> MultibodyRun | ReducedRun:
    """The slider alone, thrown in at V0; the target is far away."""
    scene = Scene(wrist=wrist, target=Target(speed=1e-3, gap=1.0))
    if backend == "reduced":
        mechanism = scene.mechanism("reduced")
        position = {"target": -1.0}
        return simulate_reduced(mechanism, position=position, velocity={"wrist": V0}, end=end, tolerance=1e-12)
    kicked = scene.mechanism("multibody").with_impulse(Impulse("wrist", wrist.mass * V0, 0.0))
    return integrate_scene(scene, end, mechanism=kicked, tolerance=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("phi", "zeta"), [(0.0, 0.0), (0.05, 0.0), (0.3, 0.0), (0.05, 0.1), (0.2, 0.1)])
def test_coulomb_friction_in_the_wrist(backend: str, phi: float, zeta: float) -> None:
    mass, k = 9.7, 530.0
    damping, friction = 2.0 * zeta * math.sqrt(k * mass), phi * V0 * math.sqrt(k * mass)
    wrist = Wrist(mass=mass, stiffness=k, damping=damping, guide_friction=friction)
    run = slide(wrist, backend, 1.2 * math.pi / math.sqrt(k / mass) / math.sqrt(1 - zeta**2))
    i = list(run.mechanism.coordinates).index("wrist")
    for end in ("displacement_zero", "force_zero"):
        told = coulomb_slider.rebound(mass, k, friction, V0, damping=damping, end=end)
        turn, back = (run.sample(np.array([t])) for t in (told.compression_time, told.contact_time))
        assert turn.position[0, i] == pytest.approx(told.peak_deflection, rel=1e-8)
        assert turn.velocity[0, i] == pytest.approx(0.0, abs=1e-8 * V0)
        assert -back.velocity[0, i] / V0 == pytest.approx(told.restitution, rel=1e-7)
        if end == "displacement_zero":
            assert back.position[0, i] == pytest.approx(0.0, abs=1e-8 * told.peak_deflection)
        else:
            assert back.acceleration[0, i] == pytest.approx(0.0, abs=1e-7 * V0 * math.sqrt(k / mass))


@pytest.mark.parametrize("backend", BACKENDS)
def test_below_a_certain_speed_the_slider_stays(backend: str) -> None:
    mass, k, phi = 9.7, 530.0, 0.6
    friction = phi * V0 * math.sqrt(k * mass)
    run = slide(Wrist(mass=mass, stiffness=k, guide_friction=friction), backend, 2.0)
    assert [e.kind for e in run.events][-1] == "stick"
    told = coulomb_slider.rebound(mass, k, friction, V0)
    assert told.restitution == 0.0
    last = run.sample(np.array([2.0]))
    i = list(run.mechanism.coordinates).index("wrist")
    assert last.velocity[0, i] == pytest.approx(0.0, abs=1e-12)
    assert last.position[0, i] > 0.1 * told.peak_deflection


def bonded(stiffness: float, wrist: Wrist, backend: str) -> tuple[float, float]:
    """Time and target speed (over V0) when the deflection is back at zero, wrist and target stuck together."""
    light = 1.0 / (1.0 / wrist.mass + 1.0 / 9.0)
    contact = ContactLaw(stiffness, 2.0 * 0.5 * math.sqrt(stiffness * light), adhesion=1e9)
    scene = Scene(wrist=wrist, contact=contact, target=Target(speed=V0))
    end = 1.3 * math.pi / math.sqrt(wrist.stiffness / (wrist.mass + 9.0))
    kicked = scene.mechanism(backend).with_impulse(Impulse("wrist", wrist.mass * V0, 0.0))
    if backend == "reduced":
        run = simulate_reduced(kicked, velocity={"target": V0}, end=end, tolerance=1e-12)
    else:
        run = integrate_scene(scene, end, mechanism=kicked, tolerance=1e-12)
    names = list(run.mechanism.coordinates)
    low, high = 0.6 * end, end
    for _ in range(60):
        middle = 0.5 * (low + high)
        here = run.sample(np.array([middle])).position[0, names.index("wrist")]
        low, high = (middle, high) if here > 0.0 else (low, middle)
    speed = run.sample(np.array([high])).velocity[0, names.index("target")]
    return high, -float(speed) / V0


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_reduced_model_is_the_limit_of_a_hard_contact_to_first_order(backend: str) -> None:
    wrist = Wrist(stiffness=530.0, damping=9.0)
    time = kelvin_voigt.contact_time(9.7, 530.0, 9.0, "displacement_zero")
    e = kelvin_voigt.restitution(9.7, 530.0, 9.0, "displacement_zero")
    found = [bonded(k, wrist, backend) for k in (1e5, 2e5, 4e5)]
    for i, exact in ((0, time), (1, e)):
        errors = [abs(pair[i] / exact - 1.0) for pair in found]
        assert errors[-1] < 1e-3
        assert all(1.8 < errors[j] / errors[j + 1] < 2.2 for j in range(2)), errors


def test_a_held_arm_is_the_limit_of_a_heavy_spacecraft_to_first_order() -> None:
    wrist, target = Wrist(stiffness=1020.0, damping=4.0), Target(speed=0.02)
    held = simulate(Scene(wrist=wrist, target=target), tolerance=1e-11).restitution
    errors, masses = [], []
    for factor in (1e3, 2e3, 4e3):
        scene = Scene(
            "pa10_wrist", base="free", spacecraft=SpacecraftSpec(mass=500.0 * factor), wrist=wrist, target=target
        )
        found = simulate(scene, tolerance=1e-11).restitution
        errors.append(abs(found.target - held.target))
        masses.append(scene.hand.mass)
    assert masses[1] / masses[0] == pytest.approx(2.0, rel=1e-2)
    assert errors[-1] < 1e-3
    assert all(1.8 < errors[i] / errors[i + 1] < 2.2 for i in range(2)), errors


def test_contact_and_wrist_are_told_apart() -> None:
    """A wrong law is seen: Hertz is not linear."""
    found = collide(ContactLaw(STIFFNESS, law="hertz"), "multibody", 0.05, rate=1e3)
    linear = kelvin_voigt.contact_time(PAIR, STIFFNESS, 0.0, "force_zero")
    assert abs(found.restitution.contact_time / linear - 1.0) > 0.05
    assert replace(found.restitution, touches=1) == found.restitution
