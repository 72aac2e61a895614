"""Exact propagation agrees with what it replaces: the integrated reduced model, and the solution of Eqs. 2 to 4."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.simulation.exact.batch import collide, durations
from spacerobot.simulation.exact.structure import OUTLINE, NotLinearError, piecewise_linear
from spacerobot.simulation.parts import ContactLaw, EffectAt, Servo, Target, Wrist
from spacerobot.simulation.prediction import predict_exact
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import default_duration, simulate
from spacerobot.support.errors import InputError

DAMPED = Wrist(stiffness=530.0, equivalent_damping=9.69)
SCENES = {
    "held": Scene(wrist=DAMPED),
    "chaser": Scene("chaser_pa10_wrist", joints="free", wrist=DAMPED),
    "damped contact": Scene(wrist=DAMPED, contact=ContactLaw(damping=60.0)),
    "overdamped contact": Scene(contact=ContactLaw(stiffness=2e4, damping=900.0), target=Target(mass=60.0, gap=0.02)),
    "dry guide": Scene(wrist=Wrist(stiffness=530.0, guide_friction=0.4)),
    "chaser, dry guide": Scene("chaser_pa10_wrist", joints="free", wrist=Wrist(stiffness=530.0, guide_friction=0.4)),
    "adhesion": Scene(wrist=DAMPED, contact=ContactLaw(adhesion=2.0)),
    "bilateral": Scene(wrist=DAMPED, contact=ContactLaw(damping=60.0, bilateral=True)),
    "wrist in motion": Scene(wrist=Wrist(deflection=0.002, deflection_rate=0.01), target=Target(gap=0.03)),
    "gravity": Scene(approach=(1.0, 0.0, 0.0), gravity=(0.2, 0.0, 0.0), duration=0.8),
    "servo": Scene(joints="servo", servo=Servo(stiffness=4000.0, damping=40.0), wrist=DAMPED),
    "slosh": Scene(wrist=DAMPED).with_effects(
        EffectAt("hidden_oscillator", "target", {"mass_kg": 2.0, "frequency_Hz": 3.0, "damping_ratio": 0.05})
    ),
    "tilt and drag": Scene(wrist=DAMPED, duration=0.7).with_effects(
        EffectAt("table_tilt", "target", {"angle_rad": 0.01}),
        EffectAt("viscous_drag", "target", {"coefficient_Ns_m": 1.5}),
    ),
    "own hand speed": Scene("chaser_pa10_wrist", hand_speed=0.05, wrist=DAMPED, target=Target(speed=0.02, gap=0.01)),
}
RESULTS = {
    "restitution_target": "target",
    "restitution_hand": "hand",
    "restitution_point": "point",
    "first_touch": "first_touch",
    "contact_time": "contact_time",
    "contact_time_summed": "contact_time_summed",
}


@pytest.mark.parametrize("name", list(SCENES))
def test_agrees_with_the_integrated_model(name: str) -> None:
    scene = SCENES[name]
    structure, numbers = piecewise_linear(scene)
    found = collide(structure, numbers[None], scene.duration)
    trajectory = simulate(scene, backend="reduced", tolerance=1e-12, rate=20_000.0, must_touch=False)
    assert found.touches[0] == trajectory.restitution.touches >= 1
    for ours, theirs in RESULTS.items():
        expected = getattr(trajectory.restitution, theirs)
        assert getattr(found, ours)[0] == pytest.approx(expected, rel=1e-8, abs=1e-9, nan_ok=True), ours
    assert found.target_velocity[0] == pytest.approx(trajectory["target.x.velocity"][-1], abs=2e-5)
    sampled = float(trajectory["contact.force"].max())
    assert sampled * (1.0 - 1e-9) <= found.peak_force[0] <= sampled * 1.02
    assert found.peak_deflection[0] == pytest.approx(float(trajectory["wrist.deflection"].max()), rel=1e-4)


def test_agrees_with_the_closed_solution() -> None:
    scene = SCENES["chaser"]
    structure, numbers = piecewise_linear(scene)
    found = collide(structure, numbers[None])
    exact = predict_exact(scene, float(found.end[0]))
    assert exact is not None
    assert found.restitution_hand[0] == pytest.approx(exact.restitution_hand, rel=1e-10)
    assert found.contact_time[0] == pytest.approx(exact.contact_time, rel=1e-10)
    assert found.touches[0] == exact.touches


@pytest.mark.parametrize("name", ["held", "chaser", "servo", "wrist in motion"])
def test_runs_as_long_as_a_simulation_does(name: str) -> None:
    structure, numbers = piecewise_linear(SCENES[name])
    assert durations(structure, numbers[None])[0] == pytest.approx(default_duration(SCENES[name]), rel=1e-12)


def test_a_batch_is_its_collisions_bit_for_bit() -> None:
    structure, numbers = piecewise_linear(SCENES["dry guide"])
    rng = np.random.default_rng(1)
    many = numbers * rng.uniform(0.9, 1.1, (40, numbers.size))
    together = collide(structure, many)
    for i in (0, 7, 39):
        alone = collide(structure, many[i : i + 1])
        for field in (*RESULTS, "peak_force", "peak_deflection", "touches"):
            assert np.array_equal(getattr(together, field)[i], getattr(alone, field)[0], equal_nan=True)


def test_a_wrong_number_is_seen() -> None:
    structure, numbers = piecewise_linear(SCENES["held"])
    numbers = numbers.copy()
    numbers[0] *= 1.01  # the wrist's mass
    expected = simulate(SCENES["held"], backend="reduced", tolerance=1e-12).restitution.target
    assert abs(collide(structure, numbers[None]).restitution_target[0] - expected) > 1e-5


@pytest.mark.parametrize(
    "scene",
    [
        Scene(contact=ContactLaw(law="hertz")),
        Scene(contact=ContactLaw(mu=0.2)),
        Scene(target=Target(contact_point=(0.15, 0.02))),
        Scene(target=Target(contact_point=(0.15, 0.0), spin=(0.0, 0.0, 0.1))),
        Scene().with_effects(EffectAt("cubic_stiffness", "wrist", {"k3_N_m3": 1e4})),
        Scene().with_effects(
            EffectAt(
                "stribeck_friction", "wrist", {"static_force_N": 0.5, "coulomb_force_N": 0.3, "velocity_m_s": 0.01}
            )
        ),
    ],
)
def test_what_is_not_linear_is_refused(scene: Scene) -> None:
    with pytest.raises(NotLinearError, match="not piecewise linear"):
        piecewise_linear(scene)


def test_numbers_that_cannot_be_are_refused() -> None:
    structure, numbers = piecewise_linear(SCENES["held"])
    with pytest.raises(InputError, match="shape"):
        collide(structure, numbers[None, :-1])
    with pytest.raises(InputError, match="positive"):
        collide(structure, -numbers[None])
    still = numbers.copy()
    still[structure.size - len(OUTLINE) + OUTLINE.index("closing_speed")] = 0.0
    with pytest.raises(InputError, match="no contact time"):
        collide(structure, still[None])
