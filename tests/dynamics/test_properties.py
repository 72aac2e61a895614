"""What must hold for any pose, direction and attitude."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pinocchio as pin
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from spacerobot.dynamics.effective_mass import EffectiveMass, effective_mass
from spacerobot.model.robot import Robot
from tests.dynamics.support import robot, turn, with_base

angles = arrays(float, 7, elements=st.floats(-3.0, 3.0))
unit = (
    arrays(float, 3, elements=st.floats(-1.0, 1.0))
    .filter(lambda v: np.linalg.norm(v) > 0.1)
    .map(lambda v: v / np.linalg.norm(v))
)
quaternions = arrays(float, 4, elements=st.floats(-1.0, 1.0)).filter(lambda v: np.linalg.norm(v) > 0.1)
few = settings(max_examples=40, deadline=None, derandomize=True)


def at(model: Robot, **options: object) -> EffectiveMass:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return effective_mass(model, **options)  # type: ignore[arg-type]


@few
@given(pose=angles, n=unit, quaternion=quaternions, joints=st.sampled_from(["free", "locked"]))
def test_turning_robot_and_direction_together_changes_nothing(
    pose: np.ndarray, n: np.ndarray, quaternion: np.ndarray, joints: str
) -> None:
    chaser = robot("chaser_pa10_wrist")
    q = chaser.configuration(pose)
    moved = with_base(chaser, q, quaternion, np.array([3.0, -1.0, 0.5]))
    here = at(chaser, configuration=q, direction=n, joints=joints)
    there = at(chaser, configuration=moved, direction=turn(quaternion) @ n, joints=joints)
    largest = np.linalg.norm(here.mobility[:3, :3], 2)
    assert abs(here.mobility_per_kg - there.mobility_per_kg) < 1e-9 * largest
    np.testing.assert_allclose(here.base_velocity_per_impulse, there.base_velocity_per_impulse, atol=1e-9 * largest)


@few
@given(pose=angles, n=unit)
def test_a_direction_and_its_opposite_are_alike(pose: np.ndarray, n: np.ndarray) -> None:
    for name in ("pa10_wrist", "chaser_pa10_wrist"):
        here, there = at(robot(name), pose=pose, direction=n), at(robot(name), pose=pose, direction=-n)
        assert here.effective_mass_kg == there.effective_mass_kg


@few
@given(pose=angles, n=unit, factor=st.floats(0.1, 10.0))
def test_masses_scale_together(pose: np.ndarray, n: np.ndarray, factor: float) -> None:
    arm = robot("chaser_pa10_wrist")
    model = arm.model.copy()
    for i in range(1, model.njoints):
        body = model.inertias[i]
        model.inertias[i] = pin.Inertia(factor * body.mass, body.lever, factor * body.inertia)
    model.armature = factor * model.armature
    light, heavy = at(arm, pose=pose, direction=n), at(replace(arm, model=model), pose=pose, direction=n)
    largest = np.linalg.norm(light.mobility[:3, :3], 2)
    assert abs(light.mobility_per_kg - factor * heavy.mobility_per_kg) < 1e-9 * largest


@few
@given(pose=angles, n=unit, extra=st.floats(0.0, 100.0))
def test_more_mass_is_never_lighter(pose: np.ndarray, n: np.ndarray, extra: float) -> None:
    arm = robot("chaser_pa10_wrist")
    model = arm.model.copy()
    model.inertias[4] = model.inertias[4] + pin.Inertia.FromSphere(extra + 1e-6, 0.1)
    light, heavy = at(arm, pose=pose, direction=n), at(replace(arm, model=model), pose=pose, direction=n)
    assert heavy.mobility_per_kg <= light.mobility_per_kg * (1.0 + 1e-9)
