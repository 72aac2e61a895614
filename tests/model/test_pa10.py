from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

from spacerobot.model.library import load
from tests.model.laws import POSE, effective_masses, placement

LENGTHS = {"pa10": (0.315, 0.450, 0.500, 0.080), "pa10c": (0.317, 0.450, 0.480, 0.070)}
NAMES = ("S1", "S2", "S3", "E1", "E2", "W1", "W2")


@pytest.mark.parametrize("name", LENGTHS)
def test_lengths_between_shoulder_elbow_wrist_and_flange(name: str) -> None:
    robot = load(name)
    q = robot.configuration()
    heights = [placement(robot, q, frame).translation for frame in ("S2", "E1", "W1", "flange")]
    assert np.allclose(np.diff([np.zeros(3), *heights], axis=0), [[0, 0, length] for length in LENGTHS[name]])
    assert np.allclose(placement(robot, q, "flange").rotation, np.eye(3))


@pytest.mark.parametrize("name", LENGTHS)
def test_axes_alternate_z_and_y_and_meet_on_one_line(name: str) -> None:
    robot = load(name)
    assert robot.chain == NAMES
    kinds = [robot.model.joints[robot.joint_id(j)].shortname() for j in NAMES]
    assert kinds == ["JointModelRZ", "JointModelRY"] * 3 + ["JointModelRZ"]
    assert all(np.allclose(m.translation[:2], 0) for m in robot.model.jointPlacements)


def test_effective_mass_of_the_bare_arm_at_the_flange() -> None:
    robot = load("pa10")
    assert effective_masses(robot, robot.configuration(POSE), "flange") == pytest.approx([7.53, 2.28, 1.48], abs=5e-3)


def test_without_rotors_the_effective_mass_is_another() -> None:
    bare = load("pa10", armature=False)
    assert not bare.model.armature.any()
    with_rotors = effective_masses(load("pa10"), bare.configuration(POSE), "flange")
    ratio = effective_masses(bare, bare.configuration(POSE), "flange") / with_rotors
    assert np.all((ratio > 0.15) & (ratio < 0.85)), "rotors change the effective mass by 20 to 80 %"


@pytest.mark.parametrize("name", LENGTHS)
def test_reflected_rotor_inertia_is_that_of_mbdyn_and_humans(name: str) -> None:
    assert load(name).model.armature == pytest.approx([0.75, 0.75, 0.2125, 0.2125, 0.00575, 0.00575, 0.00575])


@pytest.mark.parametrize("name", LENGTHS)
def test_limits_masses_and_torques(name: str) -> None:
    model = load(name).model
    limits = [177, 94, 174, 137, 255, 165, 255]
    assert np.degrees(model.upperPositionLimit) == pytest.approx(limits, abs=1e-4)
    assert np.degrees(model.lowerPositionLimit) == pytest.approx([-v for v in limits], abs=1e-4)
    assert np.degrees(model.velocityLimit) == pytest.approx([57, 57, 114, 114, 360, 360, 360], abs=1e-4)
    assert model.effortLimit == pytest.approx([158, 158, 68, 68, 17, 17, 17])
    assert [i.mass for i in model.inertias] == pytest.approx([3.04, 9.78, 8.41, 3.51, 4.31, 3.45, 1.46, 0.24])


def test_gravity_torques_equal_the_sum_over_the_listed_centres_of_mass() -> None:
    """About the horizontal axes S2, E1 and W1, from masses and lever arms alone."""
    robot = load("pa10")
    alpha, beta, gamma = np.radians([30.0, 50.0, -20.0])
    q = robot.configuration(np.array([0.0, alpha, 0.0, beta, 0.0, gamma, 0.0]))
    torque = pin.computeGeneralizedGravity(robot.model, robot.model.createData(), q)
    upper, fore, hand = np.sin([alpha, alpha + beta, alpha + beta + gamma])
    wrist = 1.46 * -0.030 * hand + 0.24 * 0.051 * hand
    elbow = (4.31 * 0.04609 + 3.45 * (0.5 - 0.1647) + 1.70 * 0.5) * fore + wrist
    shoulder = (8.41 * 0.06325 + 3.51 * (0.45 - 0.08944) + (4.31 + 3.45 + 1.70) * 0.45) * upper + elbow
    assert -torque[[1, 3, 5]] == pytest.approx(9.81 * np.array([shoulder, elbow, wrist]), rel=1e-12)


@pytest.mark.parametrize("name", ["pa10", "pa10c", "pa10_wrist", "chaser_pa10_wrist", "chaser", "target", "wrist"])
def test_every_body_can_be_seen_and_touched(name: str) -> None:
    root = etree.fromstring(load(name).urdf)
    materials = {m.get("name") for m in root.findall("material")}
    for link in root.findall("link"):
        if link.find("inertial") is not None:
            assert link.find("visual") is not None, link.get("name")
            assert link.find("collision") is not None, link.get("name")
        assert {m.get("name") for m in link.iter("material")} <= materials


@pytest.mark.parametrize("name", LENGTHS)
def test_the_file_says_where_its_numbers_come_from(name: str) -> None:
    text = load(name).urdf
    for source in ("OpenHRP", "Choreonoid", "MBDyn", "HuMAns", "ROS2", "[estimate]"):
        assert source in "".join(c.text for c in etree.fromstring(text).xpath("//comment()")) or source in _head(name)


def _head(name: str) -> str:
    from spacerobot.support import resources

    return (resources.folder("urdf") / f"{name}.urdf").read_text(encoding="utf-8")
