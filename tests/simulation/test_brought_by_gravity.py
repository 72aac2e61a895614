"""A target that rests, or still recedes, and is brought to the wrist by gravity, a tilt or a knock."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.simulation.arrival import arrival_time
from spacerobot.simulation.exact.batch import collide
from spacerobot.simulation.exact.structure import piecewise_linear
from spacerobot.simulation.parts import ContactLaw, EffectAt, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import default_duration, simulate
from spacerobot.support.errors import InputError

FALLING = Scene(
    approach=(1.0, 0.0, 0.0),
    wrist=Wrist(stiffness=2000.0, damping=150.0),
    contact=ContactLaw(damping=100.0),
    target=Target(mass=9.0, speed=0.0, gap=0.02),
    gravity=(0.5, 0.0, 0.0),
)


@settings(max_examples=200, derandomize=True, deadline=None)
@given(*(st.floats(low, high).map(lambda x: round(x, 9)) for low, high in ((0.0, 1.0), (-2.0, 2.0), (-10.0, 10.0))))
def test_the_way_is_covered_at_the_arrival(gap: float, speed: float, pull: float) -> None:
    time = arrival_time(gap, speed, pull)
    assert time >= 0.0
    if math.isinf(time):
        assert speed <= 0.0
        assert pull <= 0.0
        return
    covered = speed * time + 0.5 * pull * time**2
    turned_back = pull < 0.0 and speed * speed + 2.0 * pull * gap <= 0.0
    if turned_back:
        covered = speed * time
    assert covered == pytest.approx(gap, abs=1e-9 * (gap + abs(speed) * time + abs(pull) * time**2) + 1e-300)
    if not turned_back:
        assert speed + pull * time >= -1e-9, "and it closes as it arrives"
    several = arrival_time(np.array([gap, gap]), np.array([speed, 1.0]), pull)
    assert several[0] == time


@pytest.mark.slow
@settings(max_examples=4, derandomize=True, deadline=None)
@given(st.floats(0.0, 0.03), st.floats(-0.04, 0.0), st.floats(0.2, 3.0))
def test_whoever_simulates_it_sees_the_same_fall(gap: float, speed: float, pull: float) -> None:
    scene = replace(FALLING, gravity=(pull, 0.0, 0.0), target=replace(FALLING.target, speed=speed, gap=gap))
    end = math.ceil(1000.0 * scene.arrival + 120.0) / 1000.0  # a sample falls on it
    structure, numbers = piecewise_linear(scene)
    exact = collide(structure, numbers[None], end)
    for backend in ("reduced", "multibody"):
        found = simulate(scene, backend=backend, duration=end, tolerance=1e-10, rate=1000.0)
        assert found.restitution.first_touch == pytest.approx(exact.first_touch[0], abs=1e-9)
        flight = found.time < found.restitution.first_touch
        np.testing.assert_allclose(found["target.x.velocity"][flight], speed + pull * found.time[flight], atol=1e-9)
        assert found["target.x.velocity"][-1] == pytest.approx(exact.target_velocity[0], abs=1e-6)
        assert found.ledger.closure < 1e-7


def test_it_comes_to_rest_on_its_weight() -> None:
    """The wrist's spring then carries wrist and target."""
    for backend in ("reduced", "multibody"):
        found = simulate(FALLING, backend=backend, duration=2.0)
        weight = (FALLING.wrist.mass + FALLING.target.mass) * FALLING.gravity[0]
        assert found["wrist.deflection"][-1] == pytest.approx(weight / FALLING.wrist.stiffness, rel=1e-3)
        assert found["contact.force"][-1] == pytest.approx(FALLING.target.mass * FALLING.gravity[0], rel=1e-3)


def test_a_tilt_or_a_knock_brings_it_too() -> None:
    tilt = EffectAt("table_tilt", "target", {"angle_rad": 0.02})
    near = replace(FALLING.target, gap=0.005)
    tilted = replace(FALLING, gravity=(0.0, 0.0, 0.0), duration=1.0, target=near, effects=(tilt,))
    knock = EffectAt("external_impulse", "target", {"impulse_Ns": 0.9, "time_s": 0.2})
    assert tilted.pull == pytest.approx(9.80665 * math.sin(0.02))
    for backend in ("reduced", "multibody"):
        found = simulate(tilted, backend=backend)
        assert found.restitution.first_touch == pytest.approx(math.sqrt(2.0 * 0.005 / tilted.pull), rel=1e-9)
        found = simulate(replace(tilted, effects=(knock,)), backend=backend)
        assert found.restitution.first_touch == pytest.approx(0.2 + 0.005 / 0.1, rel=1e-9)
    with pytest.raises(InputError, match="a duration"):
        default_duration(replace(tilted, effects=(knock,), duration=None))


@pytest.mark.parametrize(
    "changed",
    [
        {"gravity": (0.0, 0.0, 0.0)},
        {"gravity": (0.0, 0.0, -9.81)},
        {"gravity": (-0.5, 0.0, 0.0)},
        {"robot": "chaser_pa10_wrist", "base": "free"},
    ],
    ids=["none", "across", "away", "everything falls alike"],
)
def test_what_nothing_brings_is_refused(changed: dict) -> None:
    with pytest.raises(InputError, match=r"target\.speed.*never arrives.*valid: a positive closing speed, or gravity"):
        replace(FALLING, **changed)


def test_a_fall_that_takes_too_long_is_refused() -> None:
    with pytest.raises(InputError, match=r"duration.*takes 0\.2828 s"):
        replace(FALLING, duration=0.25)
    assert replace(FALLING, duration=0.29).arrival == pytest.approx(math.sqrt(2.0 * 0.02 / 0.5))


def test_a_sweep_may_begin_at_rest() -> None:
    pytest.importorskip("pyarrow", reason="extra 'scale' is not installed")
    from pathlib import Path

    from spacerobot.sweep.engine import EXACT, Engine
    from spacerobot.sweep.sweep_file import plan_from_text

    text = (
        "format = 1\n[scene]\napproach = [1, 0, 0]\n"
        "gravity = [0.5, 0.0, 0.0]\n[scene.wrist]\nstiffness = 2000.0\ndamping = 150.0\n"
        "[scene.contact]\ndamping = 100.0\n[scene.target]\ngap = 0.02\n"
        "[grid]\n'target.speed' = [0.0, 0.05]\n"
    )
    engine = Engine(plan_from_text(text, Path()))
    assert engine.method == EXACT
    found = engine.columns(0, 2)
    scene = replace(FALLING, backend="reduced")
    for i, speed in enumerate((0.0, 0.05)):
        alone = simulate(replace(scene, target=replace(scene.target, speed=speed)))
        assert found["first_touch_s"][i] == pytest.approx(alone.restitution.first_touch, abs=1e-8)
        assert found["touches"][i] == alone.restitution.touches
