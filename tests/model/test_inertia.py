from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.model.inertia import inertia_fault
from spacerobot.model.library import load
from spacerobot.support.errors import InputError

MASSLESS = '<link name="{}"/>'
BODY = """<link name="{}"><inertial><origin xyz="0 0 0.1"/><mass value="{}"/>
  <inertia ixx="{}" iyy="{}" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
TURN = """<joint name="{}" type="continuous"><parent link="{}"/><child link="{}"/><axis xyz="0 1 0"/></joint>"""
FIX = """<joint name="{}" type="fixed"><parent link="{}"/><child link="{}"/></joint>"""


def _robot(*parts: str) -> str:
    return f"<robot name='r'>{''.join(parts)}</robot>"


@settings(max_examples=40, derandomize=True, deadline=None)
@given(points=st.lists(st.tuples(*[st.floats(-1, 1)] * 3), min_size=4, max_size=8), seed=st.integers(0, 99))
def test_clouds_of_mass_points_are_possible_and_stay_so_when_turned(
    points: list[tuple[float, float, float]], seed: int
) -> None:
    r = np.array(points) - np.mean(points, axis=0)
    inertia = sum(p @ p * np.eye(3) - np.outer(p, p) for p in r)
    if np.linalg.eigvalsh(inertia)[0] < 1e-6:
        return
    turn = pin.exp3(np.random.default_rng(seed).normal(size=3))
    assert inertia_fault(len(points), inertia) is None
    assert inertia_fault(len(points), turn @ inertia @ turn.T) is None


@pytest.mark.parametrize(
    ("mass", "moments", "word"),
    [
        (0.0, (1, 1, 1), "not positive"),
        (-1.0, (1, 1, 1), "not positive"),
        (1.0, (0, 1, 1), "positive definite"),
        (1.0, (-1, 1, 1), "positive definite"),
        (1.0, (1, 1, 2.001), "triangle"),
        (1.0, (1, 1, 2 * (1 + 2e-6)), "triangle"),
        (np.nan, (1, 1, 1), "finite"),
        (1.0, (np.inf, 1, 1), "finite"),
    ],
)
def test_impossible_bodies(mass: float, moments: tuple[float, ...], word: str) -> None:
    assert word in str(inertia_fault(mass, np.diag(np.array(moments, dtype=float))))


def test_the_triangle_inequality_has_the_stated_tolerance() -> None:
    assert inertia_fault(1.0, np.diag([1, 1, 2 * (1 + 5e-7)])) is None


def test_a_lump_may_hold_what_alone_could_not_be() -> None:
    """A flat link (triangle inequality broken) fixed to a big one is legal: the composite body is possible."""
    flat = BODY.format("flat", 0.1, 0.001, 0.001, 0.01)
    joined = _robot(
        MASSLESS.format("base"), BODY.format("arm", 5, 1, 1, 1), flat,
        TURN.format("j", "base", "arm"), FIX.format("f", "arm", "flat"),
    )  # fmt: skip
    assert load(joined).chain == ("j",)
    alone = _robot(MASSLESS.format("base"), flat, TURN.format("j", "base", "flat"))
    with pytest.raises(InputError, match=r"link 'flat'.*triangle"):
        load(alone)


def test_massless_frames_are_legal_and_massless_moving_bodies_are_not() -> None:
    frames = _robot(
        MASSLESS.format("base"), MASSLESS.format("hub"), BODY.format("arm", 1, 1, 1, 1), MASSLESS.format("tip"),
        TURN.format("j", "base", "hub"), FIX.format("a", "hub", "arm"), FIX.format("b", "arm", "tip"),
    )  # fmt: skip
    assert load(frames).tip == "tip"
    with pytest.raises(InputError, match="link 'hub'"):
        load(_robot(MASSLESS.format("base"), MASSLESS.format("hub"), TURN.format("j", "base", "hub")))


def test_a_floating_root_needs_a_body_and_a_fixed_one_does_not() -> None:
    urdf = _robot(MASSLESS.format("base"), BODY.format("arm", 1, 1, 1, 1), TURN.format("j", "base", "arm"))
    assert load(urdf).chain == ("j",)
    with pytest.raises(InputError, match="link 'base'"):
        load(urdf, floating=True)


def test_rotor_inertia_does_not_excuse_an_impossible_body() -> None:
    rotor = """<transmission name="t"><joint name="j"/><actuator name="m">
      <d:rotor_inertia xmlns:d="http://drake.mit.edu" value="1"/></actuator></transmission>"""
    with pytest.raises(InputError, match="link 'hub'"):
        load(_robot(MASSLESS.format("base"), MASSLESS.format("hub"), TURN.format("j", "base", "hub"), rotor))


def test_rotors_of_one_joint_add_up() -> None:
    """Two motors on a joint both turn with it; each counts with the square of its own gear."""
    from lxml import etree

    from spacerobot.model.armature import read_armature

    motor = """<transmission name="t{0}"><joint name="j"/><actuator name="m{0}"><d:gear_ratio
      xmlns:d="http://drake.mit.edu" value="{1}"/><d:rotor_inertia xmlns:d="http://drake.mit.edu" value="{2}"/>
      </actuator></transmission>"""
    robot = f'<robot name="r"><joint name="j"/>{motor.format(1, 3, 0.5)}{motor.format(2, 10, 0.01)}</robot>'
    assert read_armature(etree.fromstring(robot), "r") == {"j": pytest.approx(9 * 0.5 + 100 * 0.01)}
