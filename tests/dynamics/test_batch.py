from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from spacerobot.dynamics.batch import effective_mass_batch, mobility_batch
from spacerobot.dynamics.mobility import by_inverse
from spacerobot.dynamics.regime import Regime
from spacerobot.dynamics.terms import terms_of
from spacerobot.model.library import load
from spacerobot.support.errors import InputError
from tests.dynamics.support import REGIMES, directions, poses, robot


@pytest.mark.parametrize("regime", REGIMES, ids=str)
@pytest.mark.parametrize("name", ["pa10", "pa10_wrist", "chaser_pa10_wrist", "panda", "kinova"])
def test_many_poses_are_as_one(name: str, regime: Regime) -> None:
    model = robot(name)
    if regime.base == "free" and not model.floating:
        model = robot(name, floating=True)
    q = poses(model, 6)
    others = {model.slider: 0.02} if model.slider else {}
    for frame in [None, model.model.frames[-1].name, *([model.contact] if model.contact else [])]:
        options = {"frame": frame, "base": regime.base, "joints": regime.joints, "slider": regime.slider}
        found = mobility_batch(model, q, spatial=True, others=others, **options)
        linear = mobility_batch(model, q, others=others, **options)
        np.testing.assert_allclose(linear, found[:, :3, :3], rtol=1e-12, atol=1e-300)
        for pose, one in zip(q, found, strict=True):
            expected = by_inverse(terms_of(model, model.configuration(pose, others=others), regime, frame))
            for block in (slice(0, 3), slice(3, 6)):
                size = max(np.linalg.norm(expected[block, block], 2), 1e-300)
                assert abs(one[block, block] - expected[block, block]).max() <= 1e-10 * size


def test_the_comparison_can_fail() -> None:
    model = robot("pa10")
    bare = model.model.copy()
    bare.armature = np.zeros(bare.nv)
    q = poses(model, 3)
    with_rotors, without = mobility_batch(model, q), mobility_batch(replace(model, model=bare), q)
    assert abs(with_rotors - without).max() > 0.1


def test_directions_and_threads() -> None:
    model = robot("chaser_pa10_wrist")
    q, n = poses(model, 37), directions(5)
    one = effective_mass_batch(model, q, n)
    three = effective_mass_batch(model, q, n, threads=3)
    assert one.effective_mass_kg.shape == (37, 5)
    np.testing.assert_array_equal(one.effective_mass_kg, three.effective_mass_kg)
    np.testing.assert_allclose(one.effective_mass_kg, 1.0 / np.einsum("ki,nij,kj->nk", n, one.mobility, n), rtol=1e-12)


def test_singular_poses_are_infinite() -> None:
    batch = effective_mass_batch(robot("pa10"), [np.zeros(7), np.full(7, 0.3)], np.eye(3))
    assert np.isinf(batch.effective_mass_kg[0]).tolist() == [False, True, True]
    assert np.isfinite(batch.effective_mass_kg[1]).all()
    locked = effective_mass_batch(robot("pa10"), np.zeros(7), np.eye(3), joints="locked")
    assert np.isinf(locked.effective_mass_kg).all()


def test_no_poses_is_no_answer_but_no_error() -> None:
    assert effective_mass_batch(robot("pa10"), np.zeros((0, 7))).effective_mass_kg.shape == (0, 1)


def test_oblique_and_sliding_joints() -> None:
    text = """<robot name="odd"><link name="b"><inertial><mass value="20"/>
        <inertia ixx="2" iyy="3" izz="4" ixy="0.1" ixz="0.2" iyz="0.3"/></inertial></link>
      <joint name="j1" type="revolute"><parent link="b"/><child link="l1"/><origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/>
        <axis xyz="0.6 0 0.8"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
      <link name="l1"><inertial><origin xyz="0.1 0 0.05" rpy="0.2 0.1 0"/><mass value="2"/>
        <inertia ixx="0.1" iyy="0.12" izz="0.13" ixy="0.01" ixz="0" iyz="0.02"/></inertial></link>
      <joint name="j2" type="prismatic"><parent link="l1"/><child link="l2"/><origin xyz="0 0.3 0" rpy="1 0 0.2"/>
        <axis xyz="0 0.6 -0.8"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
      <link name="l2"><inertial><origin xyz="0 0.1 0.05"/><mass value="1.5"/>
        <inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0.001" iyz="0"/></inertial></link>
      <joint name="j3" type="continuous"><parent link="l2"/><child link="l3"/><origin xyz="0 0 0.2" rpy="0 1 0"/>
        <axis xyz="0 -1 0"/></joint>
      <link name="l3"><inertial><origin xyz="0.1 0.1 0"/><mass value="1"/>
        <inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="e" type="fixed"><parent link="l3"/><child link="tip"/><origin xyz="0.2 0.1 0.3"/></joint>
      <link name="tip"/></robot>"""
    for floating in (False, True):
        model = load(text, tip="tip", floating=floating)
        q = poses(model, 5)
        found = mobility_batch(model, q, spatial=True)
        for pose, one in zip(q, found, strict=True):
            regime = Regime("free" if floating else "fixed", "free")
            expected = by_inverse(terms_of(model, model.configuration(pose), regime))
            np.testing.assert_allclose(one, expected, rtol=1e-9, atol=1e-11 * abs(expected).max())


def test_an_impossible_inertia_is_named_by_pose() -> None:
    model = robot("pa10")
    broken = model.model.copy()
    broken.armature = np.zeros(broken.nv)
    broken.inertias[7] = pin.Inertia.Zero()
    with pytest.raises(InputError, match="pose 0"):
        mobility_batch(replace(model, model=broken), poses(model, 2))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"poses": np.zeros((2, 6))}, "wrong shape"),
        ({"poses": [[math.nan] * 7]}, "not finite"),
        ({"poses": "abc"}, "not numeric"),
        ({"joints": "servo"}, "frequency"),
        ({"base": "free"}, "fixed base"),
        ({"threads": 0}, "at least 1"),
        ({"frame": "nowhere"}, "unknown frame"),
        ({"directions": [1.0, 1.0, 1.0]}, "unit vector"),
        ({"directions": [[1.0, 0.0, 0.0], [1.0, 1.0, 1.0]]}, "1, 1, 1"),
        ({"others": {"W9": 0.0}}, "unknown joint"),
    ],
)
def test_bad_input(options: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        effective_mass_batch(robot("pa10"), **({"poses": np.zeros(7)} | options))
