"""What a body carries has its share of the body's motion from the start, whoever simulates it."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.effects.laws import SPRING
from spacerobot.effects.primitives import Coordinate, Force
from spacerobot.simulation.exact.batch import collide
from spacerobot.simulation.exact.structure import piecewise_linear
from spacerobot.simulation.parts import ContactLaw, EffectAt, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate

WHOLE = Scene(
    wrist=Wrist(stiffness=530.0, damping=2.0),
    contact=ContactLaw(damping=40.0),
    target=Target(mass=9.0, speed=0.1, gap=0.004),
    duration=0.7,
    approach=(1.0, 0.0, 0.0),  # momenta are the world's
)


def divided(share: float, frequency: float, damping: float, scene: Scene = WHOLE) -> Scene:
    values = {"mass_kg": share, "frequency_Hz": frequency, "damping_ratio": damping}
    return scene.with_effects(EffectAt("hidden_oscillator", "target", values))


def restitutions(scene: Scene) -> dict[str, float]:
    """Of the target, by everything that can simulate it."""
    structure, numbers = piecewise_linear(scene)
    found = {"exact": float(collide(structure, numbers[None], scene.duration).restitution_target[0])}
    for backend in ("reduced", "multibody"):
        found[backend] = simulate(scene, backend=backend, tolerance=1e-10, rate=100.0).restitution.target
    return found


SHARES, FREQUENCIES, DAMPINGS = st.floats(0.1, 6.0), st.floats(0.3, 20.0), st.floats(0.0, 0.3)


@settings(max_examples=8, derandomize=True, deadline=None)
@given(SHARES, FREQUENCIES, DAMPINGS)
def test_all_ways_to_simulate_it_agree(share: float, frequency: float, damping: float) -> None:
    found = restitutions(divided(share, frequency, damping))
    assert found["reduced"] == pytest.approx(found["exact"], abs=1e-8)
    assert found["multibody"] == pytest.approx(found["exact"], abs=1e-8)


@settings(max_examples=8, derandomize=True, deadline=None)
@given(SHARES, FREQUENCIES, st.sampled_from(["reduced", "multibody"]))
def test_dividing_a_body_leaves_its_momentum(share: float, frequency: float, backend: str) -> None:
    """The approach too: nothing moves in the target before anything touches it."""
    found = simulate(divided(share, frequency, 0.05), backend=backend, duration=0.2)
    assert found["momentum.x"][0] == pytest.approx(WHOLE.target.mass * WHOLE.target.speed, rel=1e-12)
    assert found.restitution.first_touch == pytest.approx(WHOLE.target.gap / WHOLE.target.speed, rel=1e-9)


def test_a_mass_on_a_stiff_spring_is_no_mass_of_its_own() -> None:
    known = restitutions(WHOLE)["exact"]
    for found in restitutions(divided(0.5, 100.0, 1.0)).values():
        assert found == pytest.approx(known, abs=2e-4)


@pytest.mark.parametrize("carrier", ["wrist", "target"])
def test_a_body_that_is_pushed_in_starts_with_what_it_carries(carrier: str) -> None:
    moving = replace(WHOLE, wrist=Wrist(stiffness=530.0, deflection=0.002, deflection_rate=0.01))
    mechanism = moving.mechanism("reduced").with_appendage(
        Coordinate("rider", 0.1, carrier=carrier),
        "rider",
        {"rider": 1.0, carrier: -1.0},
        Force("rider.spring", "rider", SPRING, (4.0,)),
    )
    ridden = mechanism.with_appendage(Coordinate("second", 0.1, carrier="rider"), "second", {"second": 1.0})
    start = ridden.at_start({"wrist": 0.002, "target": 0.1})
    assert start["rider"] == start["second"] == start[carrier] != 0.0
    assert ridden.at_start({"wrist": 0.002, "target": 0.1, "rider": 0.5})["second"] == 0.5
