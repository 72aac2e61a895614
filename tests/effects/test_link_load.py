"""A load on a link is a body fixed there: the same as one that a robot's own file has."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.diagnosis.machines.body_columns import BodyColumns
from spacerobot.diagnosis.machines.links import mass_of, with_masses
from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.effects.registry import effect
from spacerobot.effects.settled import form_of, shape_of
from spacerobot.model.library import load
from spacerobot.simulation.parts import EffectAt, Servo, Target
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.support.errors import InputError, NotFoundError
from tests.welded import heavier

PLACE = st.tuples(*[st.floats(-0.3, 0.3)] * 3)
CHASER = Scene("chaser_pa10_wrist", base="free", joints="free", target=Target(speed=0.05), duration=0.2)
HELD = Scene("pa10_wrist", joints="servo", servo=Servo(3000.0, 30.0), target=Target(speed=0.05), duration=0.2)


def loaded(scene: Scene, link: str, mass: float, place: tuple[float, float, float]) -> Scene:
    values = dict(zip(("mass_kg", "x_m", "y_m", "z_m"), (mass, *place), strict=True))
    return scene.with_effects(EffectAt("link_load", f"link.{link}", values))


@pytest.mark.parametrize("scene", [CHASER, HELD], ids=["chaser", "held"])
@pytest.mark.parametrize("link", ["link4", "flange"])
@pytest.mark.filterwarnings("ignore::spacerobot.simulation.room.StartWarning")
def test_a_load_is_a_body_welded_to_its_link(scene: Scene, link: str) -> None:
    """Another route to the same motion: the robot's own file with one more link. Without it the motion is another."""
    scene = replace(scene, approach=(1.0, 0.0, 0.0), backend="multibody")
    place = (0.03, -0.05, 0.08)
    robot = scene.prepared
    welded = load(heavier(robot.urdf, link, 3.0, place), floating=robot.floating)
    plain, ours, theirs = (
        simulate(one, tolerance=1e-9, must_touch=False)
        for one in (scene, loaded(scene, link, 3.0, place), replace(scene, robot=welded))
    )
    shown = [c for c in ("target.x", "wrist.deflection", "joint.W1.position") if c in ours.channels]
    assert len(shown) == 3
    for channel in shown:
        moved = np.ptp(plain[channel])
        assert np.abs(ours[channel] - theirs[channel]).max() < 1e-5 * moved
    assert max(np.abs(plain[c] - theirs[c]).max() / np.ptp(plain[c]) for c in shown) > 1e-3


@pytest.mark.filterwarnings("ignore::spacerobot.simulation.room.StartWarning")
@pytest.mark.parametrize("more", [2.0, -1.0])
def test_a_heavier_link_is_that_of_another_robot(more: float) -> None:
    """Another route to the same motion: the robot's own file with the link's mass and inertia scaled."""
    scene = replace(CHASER, approach=(1.0, 0.0, 0.0), backend="multibody")
    robot = scene.prepared
    changed = with_masses(robot, {"link4": mass_of(robot, "link4") + more}, floating=robot.floating)
    heavy = scene.with_effects(EffectAt("heavier_link", "link.link4", {"mass_kg": more}))
    plain, ours, theirs = (
        simulate(one, tolerance=1e-9, must_touch=False) for one in (scene, heavy, replace(scene, robot=changed))
    )
    for channel in ("target.x", "wrist.deflection", "joint.W1.position"):
        moved = np.ptp(plain[channel])
        assert np.abs(ours[channel] - theirs[channel]).max() < 1e-5 * moved
        assert np.abs(plain[channel] - theirs[channel]).max() > 1e-4 * moved


def test_no_more_is_taken_off_a_link_than_it_has() -> None:
    with pytest.raises(InputError, match="no mass left"):
        simulate(replace(loaded(CHASER, "flange", -500.0, (0.0, 0.0, 0.0)), backend="multibody"), must_touch=False)


def test_nothing_can_be_fixed_to_what_does_not_move() -> None:
    with pytest.raises(NotFoundError, match="place for link_load"):
        loaded(Scene("pa10_wrist", joints="locked"), "flange", 1.0, (0.0, 0.0, 0.0)).mechanism("multibody")


@given(PLACE)
def test_a_form_holds_its_place_to_a_micrometre(place: tuple[float, float, float]) -> None:
    one: Any = effect("link_load").in_form(form_of(place))
    assert np.allclose(list(one.settings.values()), place, rtol=0.0, atol=0.6e-6)
    assert shape_of(form_of(place)) == shape_of(form_of(shape_of(form_of(place))))
    assert effect(one.name).name == one.name


def test_a_form_that_says_no_place_is_refused() -> None:
    with pytest.raises(NotFoundError):
        effect("link_load~here")


@settings(max_examples=20, deadline=None)
@given(PLACE, st.floats(-0.3, 3.0), st.integers(0, 1000))
def test_torques_are_in_proportion_to_a_body_s_ten_numbers(
    place: tuple[float, float, float], mass: float, seed: int
) -> None:
    """Against inverse dynamics of the robot with the body welded on; of a load that is taken away, of the other."""
    robot, rng = load("ur5"), np.random.default_rng(seed)
    gravity, joints = (0.0, 0.0, -9.81), robot.chain
    with_it = load(heavier(robot.urdf, "wrist_3_link", abs(mass) + 1e-9, place))
    q, v, a = rng.normal(size=(3, 4, len(joints)))
    more = Rigid(with_it, gravity, joints).torque(q, v, a) - Rigid(robot, gravity, joints).torque(q, v, a)
    bodies = BodyColumns(robot, Rigid(robot, gravity, joints))
    rows = [0, 2, 5]
    columns = bodies.along(["upper_arm_link", "wrist_3_link"], rows, q, v, a).reshape(4, 3, 2, 10)
    found = columns[:, :, 1] @ (mass * bodies.numbers("wrist_3_link", place))
    assert np.allclose(found, np.sign(mass) * more[:, rows], atol=1e-6 * (1.0 + abs(mass)))
