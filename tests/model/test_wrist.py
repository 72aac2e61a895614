from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.model.library import load
from spacerobot.model.wrist import WristSpec, aim, attach_wrist, shortest_turn
from spacerobot.support.errors import InputError, NotFoundError
from tests.model.laws import ARMS, POSE, effective_masses, joint_inertia, placement, random_pose


@pytest.mark.parametrize("name", ARMS)
def test_the_wrist_sits_on_the_tip_and_leaves_the_arm_alone(name: str) -> None:
    arm = load(name)
    robot = attach_wrist(arm)
    assert robot.chain == arm.chain
    assert (robot.tip, robot.slider, robot.contact) == ("wrist_mount", "wrist_slider", "wrist_tip")
    assert robot.model.armature[:-1] == pytest.approx(arm.model.armature)
    assert robot.model.armature[-1] == 0
    pose = random_pose(arm, 1)
    tip = placement(arm, arm.configuration(pose), arm.tip)
    q = robot.configuration(pose)
    assert placement(robot, q, "wrist_mount").isApprox(tip, 1e-12)
    assert tip.actInv(placement(robot, q, "wrist_tip")).translation == pytest.approx([0, 0, WristSpec().length])


@pytest.mark.parametrize("name", ARMS)
def test_a_positive_slider_is_pushed_in_along_the_outward_axis(name: str) -> None:
    robot = attach_wrist(load(name))
    pose = random_pose(robot, 2)
    out, pushed = (placement(robot, robot.configuration(pose, slider=s), "wrist_tip") for s in (0.0, 0.02))
    axis = placement(robot, robot.configuration(pose), "wrist_mount").rotation[:, 2]
    assert pushed.translation - out.translation == pytest.approx(-0.02 * axis, abs=1e-12)


@pytest.mark.parametrize("name", ARMS)
def test_the_slider_alone_is_felt_along_its_axis_at_the_tip(name: str) -> None:
    """Beyond a free slider the effective mass along its axis is the slider's mass and nothing else."""
    robot = attach_wrist(load(name), wrist=WristSpec(mass=0.9))
    pose = random_pose(robot, 3)
    aimed = aim(robot, pose, np.array([-1.0, 0.0, 0.0]))
    assert effective_masses(aimed, aimed.configuration(pose), "wrist_tip")[0] == pytest.approx(0.9, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "frame"),
    [("panda", "panda_link8"), ("ur5", "ee_link"), ("kinova", "j2s6s200_link_4"), ("pa10", "E2")],
)
def test_any_frame_can_carry_it(name: str, frame: str) -> None:
    arm = load(name)
    robot = attach_wrist(arm, frame)
    pose = random_pose(arm, 4)
    there = placement(arm, arm.configuration(pose), frame)
    short = pose[: len(robot.chain)]
    assert robot.chain == arm.chain[: len(robot.chain)]
    assert placement(robot, robot.configuration(short), "wrist_mount").translation == pytest.approx(
        there.translation, abs=1e-9
    )


def test_mass_of_slider_and_housing_are_added() -> None:
    arm = load("pa10")
    robot = attach_wrist(arm, wrist=WristSpec(mass=1.3, mount_mass=0.4))
    assert sum(i.mass for i in robot.model.inertias) - sum(i.mass for i in arm.model.inertias) == pytest.approx(1.7)
    assert robot.model.inertias[robot.joint_id("wrist_slider")].mass == pytest.approx(1.3)


def test_with_a_vanishing_wrist_the_bare_arm_comes_back() -> None:
    arm, pose = load("pa10"), POSE
    bare = effective_masses(arm, arm.configuration(pose), "flange")
    errors = []
    for mass in (1e-2, 1e-3):
        robot = attach_wrist(arm, wrist=WristSpec(mass=mass))
        errors.append(np.abs(effective_masses(robot, robot.configuration(pose), "wrist_mount") - bare).max())
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.05), "first order in the wrist's mass"
    assert errors[1] < 5e-3


def test_rotation_turns_the_mount() -> None:
    turn = pin.rpy.rpyToMatrix(np.array([0.3, -0.7, 1.1]))
    robot = attach_wrist(load("pa10"), rotation=turn)
    assert placement(robot, robot.configuration(), "wrist_mount").rotation == pytest.approx(turn, abs=1e-12)


unit = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)


@settings(max_examples=25, derandomize=True, deadline=None)
@given(direction=unit, seed=st.integers(0, 1000))
def test_aimed_wrist_points_against_the_approach(direction: tuple[float, float, float], seed: int) -> None:
    approach = np.array(direction) / np.linalg.norm(direction)
    robot = load("pa10_wrist")
    pose = random_pose(robot, seed)
    aimed = aim(robot, pose, approach)
    assert placement(aimed, aimed.configuration(pose), "wrist_mount").rotation[:, 2] == pytest.approx(
        -approach, abs=1e-12
    )
    again = aim(aim(robot, pose, np.array([0.0, 1.0, 0.0])), pose, approach)
    assert np.allclose(
        joint_inertia(again.model, again.configuration(pose)),
        joint_inertia(aimed.model, aimed.configuration(pose)),
    )


@pytest.mark.parametrize("name", ["panda", "ur5", "kinova", "xarm7"])
def test_other_arms_and_chasers_can_be_aimed_too(name: str) -> None:
    from spacerobot.model.spacecraft import float_base

    robot = float_base(attach_wrist(load(name)))
    pose = random_pose(robot, 5)
    aimed = aim(robot, pose, np.array([0.6, 0.0, 0.8]))
    z = placement(aimed, aimed.configuration(pose), "wrist_mount").rotation[:, 2]
    assert z == pytest.approx([-0.6, 0.0, -0.8], abs=1e-12)
    assert aimed.floating


@pytest.mark.parametrize("z", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0, 1e-9, -1)])
def test_shortest_turn_is_a_rotation_even_upside_down(z: tuple[float, float, float]) -> None:
    to = np.array(z) / np.linalg.norm(z)
    turn = shortest_turn(to)
    assert turn[:, 2] == pytest.approx(to, abs=1e-12)
    assert turn.T @ turn == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1)


def test_a_wrist_in_a_users_urdf_is_found_and_keeps_its_offset_when_aimed() -> None:
    urdf = load("pa10_wrist").urdf.replace(
        '<child link="wrist_mount"/>\n    <origin xyz="0 0 0"/>',
        '<child link="wrist_mount"/>\n    <origin xyz="0 0 0.05"/>',
    )
    robot = load(urdf)
    aimed = aim(robot, POSE, np.array([-1.0, 0, 0]))
    for r in (robot, aimed):
        q = r.configuration(POSE)
        offset = placement(r, q, "flange").actInv(placement(r, q, "wrist_mount")).translation
        assert offset == pytest.approx([0, 0, 0.05])


@pytest.mark.parametrize(
    "measures",
    [
        {"mass": 0},
        {"mass": -1},
        {"mass": float("nan")},
        {"mass": "heavy"},
        {"mass": True},
        {"length": None},
        {"mass": float("inf")},
        {"length": 0},
        {"travel": 0.2},
        {"tip_radius": 0.1},
        {"mount_mass": -0.1},
    ],
)
def test_impossible_measures(measures: dict[str, object]) -> None:
    with pytest.raises(InputError, match=r"wrist|finite number"):
        WristSpec(**measures)


def test_wrong_uses() -> None:
    arm, robot = load("pa10"), load("pa10_wrist")
    with pytest.raises(InputError, match="has a wrist already"):
        attach_wrist(robot)
    with pytest.raises(NotFoundError, match="did you mean 'flange'"):
        attach_wrist(arm, "flnge")
    with pytest.raises(InputError, match="not a rotation"):
        attach_wrist(arm, rotation=2 * np.eye(3))
    with pytest.raises(InputError, match="not a rotation"):
        attach_wrist(arm, rotation=np.diag([1.0, 1.0, -1.0]))
    with pytest.raises(InputError, match="no wrist"):
        aim(arm, POSE, np.array([1.0, 0, 0]))
    for approach in ([1.0, 1.0, 0.0], [1.0, 0.0], [np.nan, 0.0, 1.0], [0.0, 0.0, 0.0]):
        with pytest.raises(InputError, match="unit vector"):
            aim(robot, POSE, np.array(approach))
    with pytest.raises(InputError, match="wrong length"):
        aim(robot, POSE[:3], np.array([1.0, 0, 0]))
