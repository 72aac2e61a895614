"""At its null values every effect of the catalogue leaves the baseline as it was, on both backends."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest

from spacerobot.effects.registry import all_effects
from spacerobot.simulation.parts import ContactLaw, EffectAt, Servo, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.support.errors import InputError

TARGET = Target(speed=0.06, gap=0.002, contact_point=(0.15, 0.01), yaw_inertia=0.4)
WRIST = Wrist(stiffness=5100.0, damping=3.0)
SCENES = {
    "held": Scene(wrist=WRIST, target=TARGET, contact=ContactLaw(damping=30.0)),
    "servo": Scene(
        wrist=WRIST, target=TARGET, contact=ContactLaw(damping=30.0), joints="servo", servo=Servo(5e3, 10.0)
    ),
    "chaser": Scene("chaser_pa10_wrist", wrist=WRIST, target=TARGET, joints="free", contact=ContactLaw(damping=30.0)),
}
DURATION = 0.25


def without(scene: Scene, removed: tuple[str, ...]) -> Scene:
    """A scene whose named constants are zero."""
    for name in removed:
        part, key = name.split(".")
        scene = replace(scene, **{part: replace(getattr(scene, part), **{key: 0.0})})
    return scene


@functools.cache
def baseline(scene: str, backend: str, removed: tuple[str, ...] = ()) -> Trajectory:
    return simulate(without(SCENES[scene], removed), backend=backend, duration=DURATION, tolerance=1e-11)


def cases() -> list[tuple[str, str, str, str]]:
    found = []
    for scene, backend in (("held", "reduced"), ("held", "multibody"), ("servo", "multibody"), ("chaser", "multibody")):
        mechanism = SCENES[scene].mechanism(backend)
        for name, effect in all_effects().items():
            places = effect.places(mechanism)
            joints = [p for p in places if p.startswith("joint.")][1:2]  # one joint stands for all, one link too
            links = [p for p in places if p.startswith("link.")][3:4]
            others = [p for p in places if not p.startswith(("joint.", "link."))]
            new = others if scene == "held" else [p for p in others if p == "base"]
            found += [(scene, backend, name, place) for place in (*new, *joints, *links)]
    return found


@pytest.mark.parametrize(("scene", "backend", "name", "place"), cases())
def test_nothing_changes(scene: str, backend: str, name: str, place: str) -> None:
    effect = all_effects()[name]
    nulls = {k: v for k, v in effect.nulls.items() if k != "time_s"}
    if "time_s" in effect.nulls:
        nulls["time_s"] = 0.1
    edited = SCENES[scene].with_effects(EffectAt(name, place, nulls))
    found = simulate(edited, backend=backend, duration=DURATION, tolerance=1e-11)
    before = baseline(scene, backend, effect.removes)
    for channels, known in ((found.channels, before.channels), (found.measured, before.measured)):
        assert set(known) <= set(channels)
        for channel, value in known.items():
            scale = max(float(np.abs(value).max()), 1e-3)
            assert np.abs(channels[channel] - value).max() <= 2e-8 * scale, channel
    assert found.restitution.target == pytest.approx(before.restitution.target, abs=1e-9)
    assert found.restitution.touches == before.restitution.touches


@pytest.mark.parametrize(("scene", "backend", "name", "place"), cases())
def test_and_with_it_the_scene_is_simulated(scene: str, backend: str, name: str, place: str) -> None:
    """Wherever an effect is offered its body, port or sensor is there."""
    values = {p.name: 0.03 if p.name == "time_s" else p.starts[0] for p in all_effects()[name].parameters}
    edited = SCENES[scene].with_effects(EffectAt(name, place, values))
    if (name, backend) in BEYOND_THE_PLANE:
        with pytest.raises(InputError, match="backend multibody"):
            edited.mechanism(backend)
        return
    found = simulate(edited, backend=backend, duration=0.06, tolerance=1e-4, rate=500.0, must_touch=False)
    assert all(np.isfinite(x).all() for x in (*found.channels.values(), *found.measured.values()))


BEYOND_THE_PLANE = {("hidden_oscillator", "reduced")}
"""What slides in a target that turns pulls it sideways."""

REMOVING = [name for name, effect in all_effects().items() if effect.removes]


@pytest.mark.parametrize("backend", ["reduced", "multibody"])
@pytest.mark.parametrize("name", REMOVING)
def test_what_an_effect_removes_is_gone_whatever_it_was(name: str, backend: str) -> None:
    """A scene and a fit, which sets those constants to zero, thus mean the same law by the same numbers."""
    effect, scene = all_effects()[name], SCENES["held"]
    values = {p.name: p.starts[0] for p in effect.parameters}
    for where in effect.places(scene.mechanism(backend)):
        put = EffectAt(name, where, values)
        assert put.apply(scene.mechanism(backend)) == put.apply(without(scene, effect.removes).mechanism(backend))


def test_constants_are_removed_at_all() -> None:
    assert REMOVING, "the law above looks at something"
    assert SCENES["held"].mechanism() != without(SCENES["held"], ("contact.damping",)).mechanism()


WITHOUT_CONTACT = {"table_curvature", "umbilical", "joint_flexibility", "lift", "off_centre"}
"""Effects of what glides or is driven alone; tests/diagnosis/parts/test_free_bodies.py, test_platform.py,
test_spinning_balls.py, tests/effects/test_joint_flexibility.py and test_off_centre.py hold them to the same."""


def test_every_effect_has_a_place_somewhere() -> None:
    placed = {name for _, _, name, _ in cases()}
    assert placed | WITHOUT_CONTACT == set(all_effects())
    assert not placed & WITHOUT_CONTACT


@pytest.mark.parametrize("backend", ["reduced", "multibody"])
def test_and_off_null_something_does(backend: str) -> None:
    edited = SCENES["held"].with_effects(EffectAt("coulomb_friction", "wrist", {"force_N": 0.2}))
    found = simulate(edited, backend=backend, duration=DURATION)
    assert np.abs(found["target.x"] - baseline("held", backend)["target.x"]).max() > 1e-5
