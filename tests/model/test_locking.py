from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from spacerobot.model.library import load
from spacerobot.model.locking import with_locked
from spacerobot.model.wrist import attach_wrist
from spacerobot.support.errors import InputError, NotFoundError
from tests.model.laws import POSE, joint_inertia, placement, random_pose


@pytest.mark.parametrize(
    ("name", "joints"),
    [
        ("pa10_wrist", ["S1", "S3", "E2"]),
        ("chaser_pa10_wrist", ["S2", "W2"]),
        ("kinova", ["j2s6s200_joint_1", "j2s6s200_joint_5"]),
        ("talos_arm", ["arm_left_3_joint"]),
    ],
)
def test_the_same_as_pinocchio_s_reduced_model_with_the_armature_kept(name: str, joints: list[str]) -> None:
    robot = load(name)
    pose = random_pose(robot, 1)
    q = robot.configuration(pose)
    theirs = pin.buildReducedModel(robot.model, [robot.joint_id(j) for j in joints], q)
    ours = with_locked(robot, pose, joints)
    assert list(ours.model.names) == list(theirs.names)
    assert ours.chain == tuple(j for j in robot.chain if j not in joints)
    kept = np.array([robot.model.armature[robot.velocity_index(j)] for j in ours.chain])
    assert np.array([ours.model.armature[ours.velocity_index(j)] for j in ours.chain]) == pytest.approx(kept)
    theirs.armature = ours.model.armature
    free = [p for j, p in zip(robot.chain, pose, strict=True) if j not in joints]
    q = ours.configuration(np.array(free))
    assert np.allclose(joint_inertia(ours.model, q), joint_inertia(theirs, q), rtol=0, atol=1e-10)
    assert placement(ours, q, robot.tip).isApprox(placement(robot, robot.configuration(pose), robot.tip), 1e-10)


def test_fingers_are_locked_by_default_where_they_are_told() -> None:
    robot = attach_wrist(load("panda"))
    closed, opened = with_locked(robot), with_locked(robot, others={"panda_finger_joint1": 0.04})
    assert closed.chain == robot.chain
    assert closed.model.nv == robot.model.nv - 2
    assert closed.slider == "wrist_slider"
    z = [placement(r, r.configuration(), "panda_leftfinger").translation for r in (closed, opened)]
    assert np.linalg.norm(z[1] - z[0]) == pytest.approx(0.04)


def test_a_robot_without_others_comes_back_as_it_is() -> None:
    robot = load("pa10")
    assert with_locked(robot) is robot


def test_all_joints_can_be_locked() -> None:
    robot = load("pa10_wrist")
    held = with_locked(robot, POSE, robot.chain)
    assert held.chain == ()
    assert list(held.model.names) == ["universe", "wrist_slider"]
    assert not held.model.armature.any()


def test_wrong_uses() -> None:
    robot = load("chaser_pa10_wrist")
    with pytest.raises(InputError, match="free-flyer"):
        with_locked(robot, joints=["root_joint"])
    with pytest.raises(InputError, match="slider"):
        with_locked(robot, joints=["wrist_slider"])
    with pytest.raises(NotFoundError, match="S1"):
        with_locked(robot, joints=["S11"])
    with pytest.raises(NotFoundError, match="joint"):
        with_locked(robot, others={"thumb": 0.1})
