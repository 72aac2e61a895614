"""Hand poses, maps over the workspace and soft poses hold what they promise."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.dynamics.hand_pose import chain_limits, hand_aim
from spacerobot.dynamics.soft_capture import soft_capture
from spacerobot.dynamics.workspace import MOST, workspace_map
from spacerobot.model.robot import Robot
from spacerobot.support.errors import InputError
from tests.dynamics.support import DEFAULT, robot

X = np.array([1.0, 0.0, 0.0])


def hand(body: Robot, pose: np.ndarray) -> pin.SE3:
    data = body.model.createData()
    pin.framesForwardKinematics(body.model, data, body.configuration(pose))
    return data.oMf[body.frame_id(body.tip)].copy()


@pytest.mark.parametrize("name", ["pa10_wrist", "chaser_pa10_wrist"])
@pytest.mark.parametrize("direction", [X, np.array([0.0, 0.6, -0.8])])
def test_the_hand_gets_there_and_points_as_before(name: str, direction: np.ndarray) -> None:
    body = robot(name)
    aim = hand_aim(body, DEFAULT, direction)
    before = hand(body, DEFAULT)
    wanted = before.translation + np.array([-0.1, 0.08, 0.12])
    pose = aim.solve(wanted, np.array(DEFAULT))
    assert pose is not None
    after = hand(body, pose)
    np.testing.assert_allclose(after.translation, wanted, atol=1e-5)
    np.testing.assert_allclose(after.rotation @ before.rotation.T @ direction, direction, atol=1e-5)
    low, high = chain_limits(body)
    assert np.all((pose >= low) & (pose <= high))
    assert aim.solve(before.translation + np.array([5.0, 0.0, 0.0]), np.array(DEFAULT)) is None


def test_a_map_is_the_effective_mass_of_its_poses() -> None:
    body = robot("pa10_wrist")
    place = hand(body, DEFAULT).translation
    axes = (place[0] + 0.1 * np.arange(-3, 9), [place[1]], place[2] + 0.1 * np.arange(-2, 3))
    found = workspace_map(body, DEFAULT, X, axes=axes)
    assert found.effective_mass_kg[3, 0, 2] == pytest.approx(effective_mass(body, DEFAULT, X).effective_mass_kg)
    assert not found.reached[-1].any(), "the arm is not that long"
    for index in np.argwhere(found.reached)[::7]:
        pose = found.poses[tuple(index)]
        np.testing.assert_allclose(hand(body, pose).translation, found.points()[tuple(index)], atol=1e-5)
        alone = effective_mass(body, pose, X).effective_mass_kg
        assert found.effective_mass_kg[tuple(index)] == pytest.approx(alone, rel=1e-9)
    way = found.way_to(found.extreme(heaviest=True))
    assert np.abs(np.diff(way, axis=0)).max() < 1.0, "neighbours' poses are near one another"
    assert found.effective_mass_kg.flat[found.extreme(heaviest=False)] == np.nanmin(found.effective_mass_kg)


@pytest.mark.parametrize("axes", [([], [0.0], [0.0]), ([0.0], [np.nan], [0.0]), ([5.0], [5.0], [5.0])])
def test_grids_that_cannot_be_are_refused(axes: tuple) -> None:
    with pytest.raises(InputError):
        workspace_map(robot("pa10_wrist"), DEFAULT, X, axes=axes)


def test_a_grid_too_fine_is_refused_before_work() -> None:
    line = np.linspace(0.0, 1.0, MOST + 1)
    with pytest.raises(InputError, match="grid"):
        workspace_map(robot("pa10_wrist"), DEFAULT, X, axes=(line, [0.0], [0.0]))


def test_soft_poses_keep_the_hand_and_are_sorted() -> None:
    body = robot("chaser_pa10_wrist")
    found = soft_capture(body, DEFAULT, X, tip_mass=200.0, joints="locked", tries=40)
    assert len(found.poses) > 20
    assert np.all(np.diff(found.effective_mass_kg) >= 0.0)
    np.testing.assert_allclose(found.poses[found.given], DEFAULT)
    there = hand(body, DEFAULT)
    for pose in found.poses[::9]:
        np.testing.assert_allclose(hand(body, pose).translation, there.translation, atol=1e-5)
    mass = found.effective_mass_kg[0]
    assert found.peak_force_N[0] == pytest.approx(0.1 * np.sqrt(530.0 * mass * 200.0 / (mass + 200.0)))
    assert found.gain < 1.0, "this pose is not the softest one"
    again = soft_capture(body, DEFAULT, X, tip_mass=200.0, joints="locked", tries=40)
    np.testing.assert_array_equal(found.poses, again.poses)


def test_against_a_light_target_the_pose_hardly_matters() -> None:
    heavy, light = (
        soft_capture(robot("chaser_pa10_wrist"), DEFAULT, X, tip_mass=m, joints="locked", tries=40).gain
        for m in (1e4, 0.1)
    )
    assert heavy < light < 1.0
    assert light > 0.9999


def test_a_locked_arm_on_the_ground_is_a_wall_everywhere() -> None:
    found = soft_capture(robot("pa10_wrist"), DEFAULT, X, tip_mass=9.0, joints="locked", tries=3)
    assert np.all(np.isinf(found.effective_mass_kg))
    np.testing.assert_allclose(found.reduced_mass_kg, 9.0)


@pytest.mark.parametrize("wrong", [{"tip_mass": 0.0}, {"speed": -1.0}, {"wrist_stiffness": np.nan}, {"tries": 0}])
def test_what_is_not_positive_is_refused(wrong: dict) -> None:
    with pytest.raises(InputError, match="positive"):
        soft_capture(robot("pa10_wrist"), DEFAULT, X, **{"tip_mass": 9.0, **wrong})
