"""What an effect may not do: a Magnus force works on nothing, a payload has no direction, kicks have no order."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Impulse
from spacerobot.effects.registry import effect
from spacerobot.simulation.parts import ContactLaw, EffectAt, Target, Wrist
from spacerobot.simulation.reduced.run import simulate as reduced
from spacerobot.simulation.rig import rig
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate

FREE = rig({"target.mass": 9.0, "target.yaw_inertia": 0.4}, lateral=True)


def flown(machine: Mechanism, velocity: dict[str, float], end: float) -> dict[str, np.ndarray]:
    """Velocities of a target that meets nothing, by coordinate."""
    run = reduced(machine, position={"target": -5.0}, velocity=velocity, end=end, tolerance=1e-11)
    assert not len(run.touches())
    taken = run.sample(np.linspace(0.0, end, 40))
    return {name: taken.velocity[:, k] for k, name in enumerate(run.layout.coordinates)}


@settings(max_examples=20, derandomize=True, deadline=None)
@given(
    c=st.floats(-3.0, 3.0), spin=st.floats(-2.0, 2.0), along=st.floats(-0.2, 0.2), across=st.floats(-0.2, 0.2),
)  # fmt: skip
def test_a_magnus_force_does_no_work_and_turns_the_path(c: float, spin: float, along: float, across: float) -> None:
    """f = c omega x v: the speed stays, and its direction turns at the rate c omega / m, the way the body spins."""
    machine = effect("magnus").apply(FREE, "target", {"coefficient_kg": c})
    found = flown(machine, {"target": along, "target.y": across, "target.yaw": spin}, 2.0)
    assert np.hypot(found["target"], found["target.y"]) == pytest.approx(math.hypot(along, across), abs=1e-10)
    assert found["target.yaw"] == pytest.approx(spin, abs=1e-12)
    angle = c * spin / 9.0 * 2.0
    assert found["target"][-1] == pytest.approx(along * math.cos(angle) - across * math.sin(angle), abs=1e-9)
    assert found["target.y"][-1] == pytest.approx(along * math.sin(angle) + across * math.cos(angle), abs=1e-9)


@pytest.mark.parametrize("mass", [0.5, -2.0, 11.0])
def test_a_payload_weighs_alike_in_every_direction(mass: float) -> None:
    """The same knock moves the target as fast along as across: p / (m + payload)."""
    machine = effect("payload").apply(FREE, "target", {"mass_kg": mass})
    kicked = machine.with_impulse(Impulse("target", 0.1, 0.5)).with_impulse(Impulse("target.y", 0.1, 0.5))
    found = flown(kicked, {}, 1.0)
    assert found["target"][-1] == pytest.approx(0.1 / (9.0 + mass), rel=1e-12)
    assert found["target.y"][-1] == pytest.approx(0.1 / (9.0 + mass), rel=1e-12)


@pytest.mark.parametrize("backend", ["reduced", "multibody"])
def test_a_payload_is_the_same_as_a_heavier_target(backend: str) -> None:
    """Met off its centre, so that it moves across too; its yaw inertia is stated."""
    target = Target(mass=9.0, speed=0.06, contact_point=(0.15, 0.02), yaw_inertia=0.4)
    scene = Scene(wrist=Wrist(stiffness=1020.0, damping=3.0), contact=ContactLaw(damping=30.0, mu=0.2), target=target)
    heavy = simulate(replace(scene, target=replace(target, mass=11.0)), backend=backend, duration=0.4, tolerance=1e-11)
    loaded = simulate(
        scene.with_effects(EffectAt("payload", "target", {"mass_kg": 2.0})),
        backend=backend, duration=0.4, tolerance=1e-11,
    )  # fmt: skip
    for name in ("target.x", "target.y", "target.yaw", "wrist.x"):
        assert loaded[name] == pytest.approx(heavy[name], abs=1e-9), name


KNOCKS = [
    EffectAt("external_impulse", "target", {"impulse_Ns": 0.05, "time_s": 0.31}),
    EffectAt("external_impulse", "target", {"impulse_Ns": -0.02, "time_s": 0.11}),
    EffectAt("external_impulse", "target.y", {"impulse_Ns": 0.03, "time_s": 0.31}),
]


@pytest.mark.parametrize("backend", ["reduced", "multibody"])
def test_knocks_are_given_at_their_times_in_whatever_order_they_are_listed(backend: str) -> None:
    target = Target(speed=0.06, gap=0.1, contact_point=(0.15, 0.0), yaw_inertia=0.4)
    scene = Scene(target=target, contact=ContactLaw(mu=0.1), approach=(1.0, 0.0, 0.0))  # velocities are the world's
    runs = [
        simulate(scene.with_effects(*order), backend=backend, duration=0.5, tolerance=1e-11, must_touch=False)
        for order in itertools.permutations(KNOCKS)
    ]
    for run in runs:
        time, along = run.time, run["target.velocity.x"] if "target.velocity.x" in run.channels else None
        for name in ("target.x", "target.y"):
            assert run[name] == pytest.approx(runs[0][name], abs=1e-12), name
        speed = np.gradient(run["target.x"], time) if along is None else along
        for until, gained in ((0.05, 0.0), (0.2, -0.02), (0.45, 0.03)):
            assert np.interp(until, time, speed) == pytest.approx(0.06 + gained / 9.0, abs=1e-6)
        across = np.gradient(run["target.y"], time)
        assert np.interp(0.45, time, across) == pytest.approx(0.03 / 9.0, abs=1e-6)


@pytest.mark.parametrize("backend", ["reduced", "multibody"])
def test_a_surface_that_pulls_does_not_rub(backend: str) -> None:
    """Friction goes with pressure: while an adhesive contact is under tension nothing acts across it."""
    target = Target(speed=0.05, gap=0.001, contact_point=(0.0, 0.0), spin=(0.0, 0.0, 0.0), yaw_inertia=0.4)
    wrist = Wrist(stiffness=1020.0, damping=3.0)
    scene = Scene(wrist=wrist, target=target, contact=ContactLaw(stiffness=2e4, damping=20.0, mu=0.3, adhesion=30.0))
    sideways = EffectAt("external_impulse", "target.y", {"impulse_Ns": 0.27, "time_s": 0.001})
    run = simulate(scene.with_effects(sideways), backend=backend, duration=0.4, tolerance=1e-10, rate=20000.0)
    force, time = run["contact.force"], run.time
    push = np.gradient(np.gradient(run["target.y"], time), time)[2:-2] * 9.0
    inner = slice(2, -2)
    pulls = np.convolve(force < -0.05, np.ones(7), "same") == 7
    presses = np.convolve(force > 0.5, np.ones(7), "same") == 7
    assert pulls.sum() > 100
    assert presses.sum() > 100
    assert np.abs(push[pulls[inner]]).max() < 1e-3
    assert -push[presses[inner]] == pytest.approx(0.3 * force[inner][presses[inner]], rel=2e-3, abs=2e-3)
