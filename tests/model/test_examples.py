"""Which of example-robot-data's robots are refused, and why; and that the rest are bodies that can exist."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest

from spacerobot.model import examples
from spacerobot.model.inertia import inertia_faults, moving_links
from spacerobot.model.library import load
from spacerobot.support.errors import InputError

REFUSED = {
    "bluevolta_bravo7_gripper": r"link 'bravo_finger1_link': mass 0 kg",
    "bravo7_gripper": r"link 'bravo_finger1_link': mass 0 kg",
    "falcon_bravo7_gripper": r"link 'bravo_finger1_link': mass 0 kg",
    "cassie": r"SDF with closed loops",
    "human": r"link 'left_upperleg_virtual': mass 0 kg",
    "icub": r"link 'r_hip_1': inertia is not positive definite",
    "icub_reduced": r"link 'r_hip_1': inertia is not positive definite",
    "romeo": r"link 'LFinger21Link': mass 0 kg",
    "talos_legs": r"has no URDF",
}
"""Name -> why, as the error says it. A massless or inertialess body behind a moving joint accelerates without bound."""


@pytest.mark.parametrize("name", examples.names())
def test_every_example_loads_or_is_refused_for_a_known_reason(name: str) -> None:
    if name in REFUSED:
        with pytest.raises(InputError, match=REFUSED[name]):
            load(name)
        return
    robot = load(name)
    assert not inertia_faults(robot.model)
    assert robot.model.existFrame(robot.tip)
    assert robot.configuration().shape == (robot.model.nq,)


def test_the_table_names_no_robot_that_is_gone() -> None:
    assert set(REFUSED) <= set(examples.names())


def _matrix(element: ET.Element | None) -> pin.SE3:
    origin = None if element is None else element.find("origin")
    if origin is None:
        return pin.SE3.Identity()
    xyz, rpy = (np.array(origin.get(k, "0 0 0").split(), dtype=float) for k in ("xyz", "rpy"))
    return pin.SE3(pin.rpy.rpyToMatrix(rpy), xyz)


def _lumped(root: ET.Element, link: str) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, first and second moment of a link and all that is fixed to it, in its frame; from the XML alone."""
    element = next(e for e in root.findall("link") if e.get("name") == link)
    mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    inertial = element.find("inertial")
    if inertial is not None:
        place = _matrix(inertial)
        values = inertial.find("inertia").attrib
        i = {k: float(values[k]) for k in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")}
        about = np.array(
            [[i["ixx"], i["ixy"], i["ixz"]], [i["ixy"], i["iyy"], i["iyz"]], [i["ixz"], i["iyz"], i["izz"]]]
        )
        mass, com = float(inertial.find("mass").get("value")), place.translation
        first = mass * com
        second = place.rotation @ about @ place.rotation.T + mass * (com @ com * np.eye(3) - np.outer(com, com))
    for joint in root.findall("joint"):
        if joint.get("type") == "fixed" and joint.find("parent").get("link") == link:
            m, f, s = _lumped(root, joint.find("child").get("link"))
            if m > 0:
                place, com = _matrix(joint), f / m
                central = place.rotation @ (s - m * (com @ com * np.eye(3) - np.outer(com, com))) @ place.rotation.T
                com = place.act(com)
                mass, first = mass + m, first + m * com
                second = second + central + m * (com @ com * np.eye(3) - np.outer(com, com))
    return mass, first, second


@pytest.mark.parametrize("name", ["pa10", "pa10_wrist", "panda", "ur5", "kinova", "xarm7", "talos_arm", "z1"])
def test_composite_bodies_agree_with_lumping_by_hand(name: str) -> None:
    robot = load(name)
    root = ET.fromstring(robot.urdf)
    for joint in range(1, robot.model.njoints):
        body = robot.model.inertias[joint]
        mass, first, second = _lumped(root, moving_links(robot.model, joint)[0])
        com = first / mass
        central = second - mass * (com @ com * np.eye(3) - np.outer(com, com))
        assert mass == pytest.approx(body.mass, rel=1e-12)
        assert com == pytest.approx(body.lever, abs=1e-12)
        assert central == pytest.approx(body.inertia, rel=1e-9, abs=1e-12 * np.trace(body.inertia) + 1e-15)
        low, middle, high = np.linalg.eigvalsh(central)
        assert low > 0
        assert low + middle >= high * (1 - 1e-6)


def test_all_faults_of_the_gripper_are_found() -> None:
    model = pin.buildModelFromUrdf(str(examples.find("bravo7_gripper").urdf))
    faults = inertia_faults(model)
    assert set(faults) == {"bravo_finger1_link", "bravo_finger2_link"}
    assert all(re.search("mass 0", fault) for fault in faults.values())
