"""Where the target comes from: along the hand unless a scene says otherwise, and said where it stands in the arm."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.model.wrist import aim
from spacerobot.simulation.parts import Servo, Target
from spacerobot.simulation.room import StartWarning, met_at_start
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_file import scene_from_text
from spacerobot.simulation.simulate import simulate
from spacerobot.support.errors import InputError

poses = st.lists(st.floats(-1.2, 1.2), min_size=7, max_size=7).map(tuple)


@settings(max_examples=25, derandomize=True, deadline=None)
@given(poses)
def test_without_a_word_the_target_comes_along_the_hand(pose: tuple[float, ...]) -> None:
    """Turning the wrist against such an approach turns it by nothing."""
    scene = Scene("chaser_pa10_wrist", joints="free", pose=pose)
    bare = scene._loaded()
    np.testing.assert_allclose(
        aim(bare, np.array(pose), np.array(scene.approach)).model.jointPlacements[-1].rotation,
        bare.model.jointPlacements[-1].rotation,
        atol=1e-8,
    )
    assert np.linalg.norm(scene.approach) == pytest.approx(1.0, abs=1e-9)


def test_at_the_usual_pose_it_does_not_stand_in_the_arm() -> None:
    for robot in ("chaser_pa10_wrist", "chaser_panda"):
        try:
            scene = Scene(robot, joints="free")
        except InputError:
            continue
        assert met_at_start(scene) is None


def test_what_a_scene_states_is_kept() -> None:
    """In a file that says so, and in what is written of any scene."""
    stated = scene_from_text('robot = "chaser_pa10_wrist"\napproach = [1, 0, 0]\n')
    assert stated.approach == (1.0, 0.0, 0.0)
    for scene in (stated, Scene("chaser_pa10_wrist"), Scene("panda")):
        assert scene_from_text(scene.to_toml()).approach == scene.approach


def test_a_target_between_the_arm_and_its_base_is_said() -> None:
    scene = Scene("chaser_pa10_wrist", joints="free", approach=(1.0, 0.0, 0.0), duration=0.1)
    with pytest.warns(StartWarning, match=r"approach \(-1, 0, 0\)"):
        simulate(scene, must_touch=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error", StartWarning)
        simulate(Scene("chaser_pa10_wrist", joints="free", duration=0.1), must_touch=False)


def test_a_held_arm_is_a_wall_from_whichever_side() -> None:
    assert met_at_start(Scene("pa10_wrist", approach=(1.0, 0.0, 0.0))) is None
    held = Scene("pa10_wrist", approach=(1.0, 0.0, 0.0), joints="servo", servo=Servo())
    assert met_at_start(held) is not None
    far = Target(gap=5.0, speed=1.0)
    assert (
        met_at_start(Scene("pa10_wrist", approach=(1.0, 0.0, 0.0), joints="servo", servo=Servo(), target=far)) is None
    )
