from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.model.library import load
from spacerobot.model.reading import parse
from spacerobot.model.spacecraft import float_base
from spacerobot.model.wrist import attach_wrist
from spacerobot.model.yourdf import read_with_yourdfpy, urdf_text, write_urdf
from spacerobot.support.errors import InputError
from tests.model.laws import joint_inertia, random_pose


@pytest.mark.parametrize("name", ["pa10_wrist", "chaser_pa10_wrist", "panda", "ur5", "kinova", "xarm7", "talos_arm"])
def test_what_is_written_is_the_same_robot_rotors_included(name: str, tmp_path: Path) -> None:
    robot = load(name)
    path = write_urdf(robot, tmp_path / "sub" / "robot.urdf")
    back = load(path, package_dirs=robot.mesh_dirs, tip=None if robot.slider else robot.tip)
    assert (back.chain, back.tip, back.slider, back.floating) == (
        robot.chain, robot.tip, robot.slider, robot.floating,
    )  # fmt: skip
    assert np.array_equal(back.model.armature, robot.model.armature)
    q = robot.configuration(random_pose(robot, 1))
    assert np.allclose(joint_inertia(back.model, q), joint_inertia(robot.model, q), rtol=0, atol=1e-12)
    assert [p.name for p in path.parent.iterdir()] == ["robot.urdf"], "no temporary file is left"


def test_assemblies_on_other_arms_can_be_written() -> None:
    robot = float_base(attach_wrist(load("kinova")))
    assert load(urdf_text(robot)).chain == robot.chain


def test_yourdfpy_finds_what_it_calls_invalid() -> None:
    root = parse("<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='screw'/></robot>")
    with pytest.raises(InputError, match="yourdfpy"):
        read_with_yourdfpy(root, "here")


def test_limits_left_out_mean_zero_and_are_valid() -> None:
    urdf = """<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>
      <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" type="revolute">
      <parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" effort="1" velocity="1"/></joint>
      </robot>"""
    model = load(urdf).model
    assert (model.lowerPositionLimit[0], model.upperPositionLimit[0]) == (-1, 0)
