from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from spacerobot.model import examples
from spacerobot.model.library import bundled, load
from spacerobot.support import resources
from spacerobot.support.errors import InputError, NotFoundError
from tests.model.laws import ARMS, POSE, joint_inertia

TIPS = {"panda": "panda_hand_tcp", "ur5": "tool0", "kinova": "j2s6s200_end_effector", "xarm7": "link_eef"}


def test_bundled_names() -> None:
    assert set(bundled()) == {
        "pa10", "pa10c", "pa10_wrist", "pa10c_wrist", "chaser_pa10_wrist", "chaser", "target", "wrist",
    }  # fmt: skip


@pytest.mark.parametrize("name", ["pa10", "pa10c", "pa10_wrist", "pa10c_wrist", "chaser_pa10_wrist"])
def test_every_assembly_has_the_same_chain_and_rotors(name: str) -> None:
    robot = load(name)
    assert robot.chain == ("S1", "S2", "S3", "E1", "E2", "W1", "W2")
    assert (robot.slider, robot.contact) == (("wrist_slider", "wrist_tip") if "wrist" in name else (None, None))
    assert robot.tip == ("wrist_mount" if "wrist" in name else "flange")
    assert robot.floating == ("chaser" in name)
    armature = [robot.model.armature[robot.velocity_index(joint)] for joint in robot.chain]
    assert armature == pytest.approx([0.75, 0.75, 0.2125, 0.2125, 0.00575, 0.00575, 0.00575])
    assert robot.model.armature.sum() == pytest.approx(sum(armature)), "neither base nor slider has a rotor"


@pytest.mark.parametrize("name", TIPS)
def test_tips_of_known_arms_and_fingers_outside_of_the_chain(name: str) -> None:
    robot = load(name)
    assert robot.tip == TIPS[name]
    assert len(robot.chain) == {"panda": 7, "ur5": 6, "kinova": 6, "xarm7": 7}[name]
    assert not any("finger" in joint for joint in robot.chain)


def test_a_tip_can_be_chosen_and_shortens_the_chain() -> None:
    robot = load("panda", tip="panda_link4")
    assert robot.chain == tuple(f"panda_joint{i}" for i in range(1, 5))
    assert load("panda", tip="panda_joint4").chain == robot.chain
    with pytest.raises(NotFoundError, match="panda_link4"):
        load("panda", tip="panda_lnk4")


def test_path_text_and_name_give_the_same_robot(tmp_path: Path) -> None:
    source = resources.folder("urdf") / "pa10_wrist.urdf"
    copy = tmp_path / "my arm.urdf"
    copy.write_bytes(source.read_bytes())
    text = source.read_text(encoding="utf-8")
    q = load("pa10_wrist").configuration(POSE, slider=0.01)
    expected = joint_inertia(load("pa10_wrist").model, q)
    for what in (copy, str(copy), text, "\ufeff\n " + text):
        robot = load(what)
        assert np.array_equal(joint_inertia(robot.model, q), expected)
        assert (robot.tip, robot.slider) == ("wrist_mount", "wrist_slider")
    assert load(copy).name == "my arm"


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ("pa10_wrst", "did you mean 'pa10_wrist'"),
        ("Panda", "did you mean 'panda'"),
        ("", "unknown robot"),
        ("no/such.urdf", "does not exist"),
        ("arm.urdf.xacro", "xacro"),
        ("<robot", "not well-formed"),
        ("a\0b.urdf", "cannot be read|does not exist"),
        ("/", "does not exist"),
        ("/dev/zero/x.urdf", "does not exist|cannot be read"),
    ],
)
def test_what_cannot_be_loaded(what: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load(what)


def test_missing_package_folder() -> None:
    with pytest.raises(InputError, match="package folder"):
        load("pa10", package_dirs=["/no/such/folder"])


def _plain(name: str) -> tuple[pin.Model, bool]:
    example = examples.find(name)
    if example.floating:
        return pin.buildModelFromUrdf(str(example.urdf), pin.JointModelFreeFlyer()), True
    return pin.buildModelFromUrdf(str(example.urdf)), False


@pytest.mark.parametrize("name", [*TIPS, "falcon_bravo7_no_ee", "so100", "anymal_kinova", "pr2", "tiago"])
def test_examples_are_what_pinocchio_reads_of_them(name: str) -> None:
    """Joint-space inertia at random configurations, the floating root written as a URDF joint or not."""
    ours, (theirs, floating) = load(name).model, _plain(name)
    assert list(ours.names) == list(theirs.names)
    assert load(name).floating == floating
    rng = np.random.default_rng(3)
    q = pin.integrate(theirs, pin.neutral(theirs), rng.normal(size=theirs.nv))
    assert np.allclose(joint_inertia(ours, q), joint_inertia(theirs, q), rtol=0, atol=1e-12 * 1e3)


def test_rotors_of_the_srdf_reach_the_armature() -> None:
    model = load("talos_arm").model
    plain, _ = _plain("talos_arm")
    pin.loadRotorParameters(plain, str(examples.find("talos_arm").rotors), False)
    expected = np.ravel(plain.rotorInertia) * np.ravel(plain.rotorGearRatio) ** 2
    assert expected.any()
    assert model.armature == pytest.approx(expected)


@pytest.mark.parametrize("name", ARMS)
def test_floating_can_be_asked_for(name: str) -> None:
    fixed, free = load(name), load(name, floating=True)
    assert (fixed.floating, free.floating) == (False, True)
    assert free.model.nv == fixed.model.nv + 6
    assert free.chain == fixed.chain
    q = fixed.configuration()
    corner = joint_inertia(free.model, free.configuration())[6:, 6:]
    assert np.allclose(corner, joint_inertia(fixed.model, q), rtol=0, atol=1e-12)
    with pytest.raises(InputError, match="floating base"):
        load(free.urdf, floating=False)


def test_a_link_and_a_joint_of_one_name_are_told_apart() -> None:
    urdf = """<robot name="twins"><link name="base"/><link name="j"><inertial><mass value="1"/>
      <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="j" type="continuous"><parent link="base"/><child link="j"/><axis xyz="0 0 1"/></joint></robot>"""
    robot = load(urdf)
    assert robot.tip == "j"
    assert robot.model.frames[robot.frame_id("j")].type == pin.FrameType.BODY
    assert robot.configuration(np.array([0.3])) == pytest.approx([np.cos(0.3), np.sin(0.3)])
