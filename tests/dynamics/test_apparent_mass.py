from __future__ import annotations

import math

import numpy as np
import pytest

from spacerobot.dynamics.apparent_mass import apparent_mass
from spacerobot.dynamics.apparent_mass_batch import apparent_mass_batch
from spacerobot.dynamics.contact_frequency import contact_frequency, reduced_mass
from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.dynamics.inertia import joint_space_inertia
from spacerobot.dynamics.jacobian import frame_jacobian
from spacerobot.model.library import load
from spacerobot.simulation.parts import Servo
from spacerobot.support.errors import InputError
from tests.dynamics.support import DEFAULT, ROD, directions, poses, robot

K = [1e5, 1e5, 5e4, 5e4, 2e4, 2e4, 1e4]
D = [200.0, 200.0, 100.0, 100.0, 20.0, 20.0, 5.0]
X = np.array([1.0, 0.0, 0.0])


@pytest.mark.parametrize("name", ["pa10", "pa10_wrist", "chaser_pa10_wrist"])
def test_the_formula_written_out(name: str) -> None:
    """1/m_app = -w^2 n^T J (-w^2 H + i w D + K)^-1 J^T n over all coordinates."""
    model = robot(name)
    q = model.configuration(DEFAULT)
    h, j = joint_space_inertia(model, q), frame_jacobian(model, q)[:3]
    stiffness, damping = np.zeros(model.model.nv), np.zeros(model.model.nv)
    for joint, k, d in zip(model.chain, K, D, strict=True):
        stiffness[model.velocity_index(joint)], damping[model.velocity_index(joint)] = k, d
    omega = np.array([3.0, 60.0, 900.0])
    for n in directions(2):
        response = apparent_mass(model, q, n, omega, servo=Servo(K, D))
        for w, found in zip(omega, response.mobility, strict=True):
            impedance = -(w**2) * h + 1j * w * np.diag(damping) + np.diag(stiffness)
            assert found == pytest.approx(-(w**2) * n @ j @ np.linalg.solve(impedance, j.T @ n), rel=1e-8)


@pytest.mark.parametrize("name", ["pa10_wrist", "chaser_pa10_wrist"])
def test_fast_forces_meet_free_joints(name: str) -> None:
    """The deviation falls with one over the frequency squared where nothing damps."""
    model = robot(name)
    for n in directions(2):
        response = apparent_mass(model, model.configuration(DEFAULT), n, [1e6, 1e7], servo=Servo(K))
        free = effective_mass(model, DEFAULT, n).mobility_per_kg
        assert response.free_mobility == pytest.approx(free, rel=1e-10)
        away = np.abs(response.mobility - free)
        assert away[0] / away[1] == pytest.approx(100.0, rel=0.05)


def test_slow_forces_meet_locked_joints_on_a_free_base() -> None:
    model = robot("chaser_pa10_wrist")
    for n in directions(2):
        response = apparent_mass(model, model.configuration(DEFAULT), n, [1e-1, 1e-2], servo=Servo(K, D))
        locked = effective_mass(model, DEFAULT, n, joints="locked").mobility_per_kg
        assert response.locked_mobility == pytest.approx(locked, rel=1e-10)
        assert abs(response.mobility[1] - locked) < 1e-6 * locked
        assert response.tip_stiffness == 0.0


def test_slow_forces_meet_a_spring_on_a_fixed_base() -> None:
    """1/m_app -> -w^2/K_tip, so m~ -> m_w + m_t, with an error that falls with w^2."""
    model = robot("pa10_wrist")
    q = model.configuration(DEFAULT)
    j = frame_jacobian(model, q)[:3, :7]
    omega = np.array([10.0, 1.0, 0.1])
    for n in directions(3):
        response = apparent_mass(model, q, n, omega, servo=Servo(K))
        compliance = float(np.sum((n @ j) ** 2 / K))
        assert response.tip_stiffness == pytest.approx(1.0 / compliance, rel=1e-9)
        relative = np.abs(response.mobility / (-(omega**2) * compliance) - 1.0)
        assert (relative[:2] < [2e-1, 2e-3]).all()
        assert relative[0] / relative[1] == pytest.approx(100.0, rel=0.1)
        np.testing.assert_allclose(np.abs(response.phase), math.pi, atol=1e-9)
        reduced = [reduced_mass(m.real, 9.7) for m in response.mobility]
        assert abs(reduced[-1] - 9.7) < 1e-4 * abs(reduced[0] - 9.7) * 1.1


def test_damping_turns_the_phase() -> None:
    response = apparent_mass(robot("pa10"), DEFAULT, X, [1e-3, 1.0], servo=Servo(0.0, D))
    assert response.tip_stiffness == 0.0
    assert response.phase[0] == pytest.approx(-math.pi / 2.0, abs=1e-3)


@pytest.mark.parametrize("name", ["pa10_wrist", "chaser_pa10_wrist"])
def test_default_frequency_is_a_mode_of_arm_wrist_and_target(name: str) -> None:
    """sqrt(k_w/m~) against the eigenvalues of the whole: servo springs, wrist spring, target stuck to the slider."""
    model = robot(name)
    q = model.configuration(DEFAULT)
    assert model.slider is not None
    axis = frame_jacobian(model, q, model.contact)[:3, model.velocity_index(model.slider)]
    n = axis / np.linalg.norm(axis)
    k_w, m_t = 530.0, 9.0
    m = effective_mass(model, DEFAULT, n, joints="servo", servo=Servo(K), wrist_stiffness=k_w, target_mass=m_t)
    h = joint_space_inertia(model, q)
    row = n @ frame_jacobian(model, q, model.contact)[:3]
    springs = np.zeros(model.model.nv)
    for joint, k in zip(model.chain, K, strict=True):
        springs[model.velocity_index(joint)] = k
    springs[model.velocity_index(model.slider)] = k_w
    squares = np.linalg.eigvals(np.linalg.solve(h + m_t * np.outer(row, row), np.diag(springs))).real
    modes = np.sqrt(np.maximum(squares, 0.0))
    assert m.omega_rad_s is not None
    assert abs(modes - m.omega_rad_s).min() < 1e-6 * m.omega_rad_s
    assert "sqrt(k_w/m~)" in m.notes[0]


def test_a_given_frequency_is_said_and_used() -> None:
    m = effective_mass(robot("pa10"), DEFAULT, X, joints="servo", servo=Servo(K, D), omega=50.0)
    response = apparent_mass(robot("pa10"), DEFAULT, X, 50.0, servo=Servo(K, D))
    assert m.effective_mass_kg == pytest.approx(response.magnitude[0], rel=1e-10)
    assert m.phase_rad == pytest.approx(response.phase[0], rel=1e-10)
    assert m.apparent_mass_kg == pytest.approx(response.mass[0], rel=1e-10)
    assert "50 rad/s" in m.notes[0]
    assert m.ellipsoid is None


def test_a_singular_direction_stays_infinite() -> None:
    m = effective_mass(robot("pa10"), np.zeros(7), [0.0, 0.0, 1.0], joints="servo", servo=Servo(K), omega=5.0)
    assert math.isinf(m.effective_mass_kg)
    assert any("infinite" in note for note in m.notes)
    response = apparent_mass(robot("pa10"), np.zeros(7), [0.0, 0.0, 1.0], 5.0, servo=Servo(K))
    assert math.isinf(response.magnitude[0])


@pytest.mark.parametrize("name", ["pa10_wrist", "chaser_pa10_wrist", "panda"])
def test_many_poses_are_as_one(name: str) -> None:
    model = robot(name)
    q, n = poses(model, 4), directions(3)
    batch = apparent_mass_batch(model, q, n, 40.0, servo=Servo(K, D))
    for pose, values, sizes, angles in zip(q, batch.mobility, batch.magnitude, batch.phase, strict=True):
        for direction, value, size, angle in zip(n, values, sizes, angles, strict=True):
            one = apparent_mass(model, model.configuration(pose), direction, 40.0, servo=Servo(K, D))
            assert value == pytest.approx(one.mobility[0], rel=1e-9)
            assert size == pytest.approx(one.magnitude[0], rel=1e-9)
            assert angle == pytest.approx(one.phase[0], abs=1e-9)


def test_many_poses_singular_or_resonant() -> None:
    arm = robot("pa10")
    stretched = apparent_mass_batch(arm, [np.zeros(7), np.full(7, 0.3)], np.eye(3), 5.0, servo=Servo(K))
    assert np.isinf(stretched.magnitude[0, 2])
    assert np.isfinite(stretched.magnitude[1]).all()
    rod = load(ROD, tip="tip")
    with pytest.raises(InputError, match="pose 0"):
        apparent_mass_batch(rod, [[0.3]], X, 10.0, servo=Servo(18.0))
    with pytest.raises(InputError, match="positive"):
        apparent_mass_batch(rod, [[0.3]], X, 0.0, servo=Servo(18.0))


def test_an_undamped_resonance_is_an_error() -> None:
    rod = load(ROD, tip="tip")
    with pytest.raises(InputError, match="resonance"):
        apparent_mass(rod, [0.0], [0.0, 1.0, 0.0], 10.0, servo=Servo(18.0))


def test_contact_frequency_gives_up_honestly() -> None:
    flip = iter([1e9, -1e9] * 200)
    omega, settled = contact_frequency(lambda w: complex(next(flip)), 100.0, 4.0)
    assert not settled
    assert omega == pytest.approx(5.0)
    assert contact_frequency(lambda w: 0.0 + 0.0j, 100.0, 4.0) == (pytest.approx(5.0), True)
