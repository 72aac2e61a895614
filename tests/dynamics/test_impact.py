from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.dynamics.impact import impact, matching_mass, target_mobility, target_speed_after
from spacerobot.dynamics.inertia import joint_space_inertia
from spacerobot.support.errors import InputError
from tests.dynamics.support import DEFAULT, directions, poses, robot

INERTIA = np.array([[0.4, 0.05, 0.0], [0.05, 0.5, 0.02], [0.0, 0.02, 0.6]])
LEVER = np.array([-0.2, 0.07, 0.05])


@pytest.mark.parametrize("joints", ["free", "locked"])
def test_an_impact_keeps_momentum_energy_and_its_own_restitution(joints: str) -> None:
    chaser = robot("chaser_pa10_wrist")
    model = chaser.model
    for pose, n in zip(poses(chaser, 4), directions(4), strict=True):
        q = chaser.configuration(pose)
        for e in (0.0, 0.6, 1.0):
            hit = impact(
                chaser,
                q,
                n,
                approach_speed=0.1,
                restitution=e,
                target_mass=9.0,
                target_inertia=INERTIA,
                target_lever=LEVER,
                joints=joints,
            )
            data = model.createData()
            pin.forwardKinematics(model, data, q, hit.velocity_jump)
            point = pin.updateFramePlacement(model, data, chaser.frame_id(chaser.tip)).translation
            gained = pin.computeCentroidalMomentum(model, data)
            center = pin.centerOfMass(model, data, q)
            p = hit.impulse_Ns
            np.testing.assert_allclose(gained.linear, p * n, atol=1e-12)
            lost = 9.0 * hit.target_linear_jump_m_s
            np.testing.assert_allclose(gained.linear + lost, 0.0, atol=1e-12)
            target_center = point - LEVER
            about_origin = gained.angular + np.cross(center, gained.linear)
            of_target = INERTIA @ hit.target_angular_jump_rad_s + np.cross(target_center, lost)
            np.testing.assert_allclose(about_origin + of_target, 0.0, atol=1e-12)
            # relative speed of the two points along n: v before, -e v after
            target_point = hit.target_linear_jump_m_s + np.cross(hit.target_angular_jump_rad_s, LEVER)
            after = 0.1 + n @ (target_point - hit.frame_velocity_jump[:3])
            assert after == pytest.approx(-e * 0.1, abs=1e-13)
            # energy: robot at rest before, target's point speed v along n before
            h = joint_space_inertia(chaser, q)
            v0 = 0.1 * n
            gain = 0.5 * hit.velocity_jump @ h @ hit.velocity_jump
            gain += 0.5 * 9.0 * (np.dot(v0 + hit.target_linear_jump_m_s, v0 + hit.target_linear_jump_m_s) - 0.01)
            gain += 0.5 * hit.target_angular_jump_rad_s @ INERTIA @ hit.target_angular_jump_rad_s
            assert gain == pytest.approx(-0.5 * hit.reduced_mass_kg * 0.01 * (1.0 - e * e), abs=1e-13)


def test_the_impulse_uses_the_effective_mass() -> None:
    chaser = robot("chaser_pa10_wrist")
    m = effective_mass(chaser, DEFAULT, [1.0, 0.0, 0.0])
    hit = impact(
        chaser, chaser.configuration(DEFAULT), [1.0, 0.0, 0.0], approach_speed=0.05, restitution=0.8, target_mass=9.0
    )
    assert hit.reduced_mass_kg == pytest.approx(1.0 / (m.mobility_per_kg + 1.0 / 9.0), rel=1e-10)
    assert hit.impulse_Ns == pytest.approx(1.8 * 0.05 * hit.reduced_mass_kg, rel=1e-12)
    np.testing.assert_allclose(hit.base_velocity_jump, hit.impulse_Ns * m.base_velocity_per_impulse, rtol=1e-10)


def test_against_a_locked_arm_on_the_ground_the_target_bounces() -> None:
    arm = robot("pa10")
    hit = impact(
        arm,
        arm.configuration(DEFAULT),
        [1.0, 0.0, 0.0],
        approach_speed=0.1,
        restitution=0.5,
        target_mass=4.0,
        joints="locked",
    )
    assert hit.reduced_mass_kg == pytest.approx(4.0)
    np.testing.assert_allclose(hit.target_linear_jump_m_s, [-0.15, 0.0, 0.0])
    assert not hit.velocity_jump.any()


def test_a_point_on_a_free_body_moves_as_a_force_there_moves_it() -> None:
    for n in directions(4):
        spin = np.linalg.solve(INERTIA, np.cross(LEVER, n))
        expected = n / 3.0 + np.cross(spin, LEVER)
        np.testing.assert_allclose(target_mobility(3.0, INERTIA, LEVER) @ n, expected, rtol=1e-12, atol=1e-14)


@settings(max_examples=50, deadline=None, derandomize=True)
@given(mass=st.floats(0.1, 100.0), e=st.floats(0.01, 1.0), speed=st.floats(0.001, 10.0))
def test_a_matching_mass_stops_the_target(mass: float, e: float, speed: float) -> None:
    match = matching_mass(mass, e)
    assert match == pytest.approx(mass / e)
    assert abs(target_speed_after(match, mass, e, speed)) < 1e-12 * speed
    assert target_speed_after(2.0 * match, mass, e, speed) < 0.0 < target_speed_after(0.5 * match, mass, e, speed)
    reduced = 1.0 / (1.0 / mass + 1.0 / match)  # momentum: what the target loses is (1 + e) v times this
    assert target_speed_after(match, mass, e, speed) == pytest.approx(
        speed - (1.0 + e) * speed * reduced / mass, abs=1e-9 * speed
    )


def test_matching_mass_at_the_ends() -> None:
    assert math.isinf(matching_mass(9.0, 0.0))
    assert target_speed_after(math.inf, 9.0, 0.4) == -0.4


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"approach_speed": -1.0}, "approach speed"),
        ({"approach_speed": math.nan}, "approach speed"),
        ({"restitution": 1.1}, "between 0 and 1"),
        ({"restitution": math.nan}, "between 0 and 1"),
        ({"target_mass": 0.0}, "must be positive"),
        ({"target_mass": math.inf}, "must be positive"),
        ({"target_lever": LEVER}, "needs the target's inertia"),
        ({"target_inertia": -INERTIA}, "positive definite"),
        ({"target_inertia": np.triu(INERTIA)}, "symmetric"),
        ({"target_inertia": INERTIA, "target_lever": [1.0]}, "three finite"),
        ({"joints": "servo"}, "servo"),
        ({"direction": [1.0, 1.0, 0.0]}, "unit vector"),
    ],
)
def test_bad_input(options: dict, message: str) -> None:
    arm = robot("pa10")
    arguments = {"direction": [1.0, 0.0, 0.0], "approach_speed": 0.1, "restitution": 0.5, "target_mass": 9.0} | options
    with pytest.raises(InputError, match=message):
        impact(arm, arm.configuration(DEFAULT), **arguments)


def test_bad_matching_mass() -> None:
    with pytest.raises(InputError, match="positive"):
        matching_mass(0.0, 0.5)
    with pytest.raises(InputError, match="between 0 and 1"):
        matching_mass(1.0, 2.0)
