"""Eqs. 1 to 19 by number: the numbers that the paper reports, and limits of the chain."""

from __future__ import annotations

import dataclasses
import importlib
import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.theory import (
    contact_time,
    equations,
    frequencies,
    kelvin_voigt,
    reduction,
    response,
    restitution,
    table1,
)
from spacerobot.theory.equations_of_motion import ThreeMasses, equivalent_mass
from spacerobot.theory.exact import solve

CASE = frequencies.PRINTED_CASE
masses = st.floats(0.1, 1e3)


def eigenvalues(system: ThreeMasses) -> np.ndarray:
    """Natural frequencies from the mass and stiffness matrices, rad/s; shape (2,), without the rigid motion."""
    m = np.diag([system.hand_mass, system.wrist_mass, system.target_mass])
    k, c = system.wrist_stiffness, system.contact_stiffness
    stiffness = np.array([[k, -k, 0], [-k, k + c, -c], [0, -c, c]])
    root = np.diag(1 / np.sqrt(np.diag(m)))
    return np.sqrt(np.sort(np.linalg.eigvalsh(root @ stiffness @ root))[1:])


def test_all_numbers_are_there_and_point_at_code() -> None:
    assert [e.number for e in equations.EQUATIONS] == list(range(1, 20))
    for equation in equations.EQUATIONS:
        module, name = equation.where.split(".")
        assert callable(getattr(importlib.import_module(f"spacerobot.theory.{module}"), name))
    assert equations.by_number(5).status == "not as printed"
    with pytest.raises(ValueError, match="1 to 19"):
        equations.by_number(20)


def test_eq_1_on_a_two_link_matrix() -> None:
    inertia = np.array([[2.0, 0.3], [0.3, 0.5]])
    jacobian = np.array([[0.4, 0.1], [0.0, 0.7], [0.0, 0.0]])
    n = np.array([0.6, 0.8, 0.0])
    # a unit impulse along n gives the hand the velocity 1/M along n
    velocity = n @ jacobian @ np.linalg.inv(inertia) @ jacobian.T @ n
    assert equivalent_mass(inertia, jacobian, n) == pytest.approx(1 / velocity, rel=1e-14)
    assert equivalent_mass(inertia, jacobian, np.array([0.0, 0.0, 1.0])) == math.inf
    with pytest.raises(ValueError, match="length 1"):
        equivalent_mass(inertia, jacobian, 2 * n)


@settings(max_examples=60, derandomize=True, deadline=None)
@given(masses, masses, masses, st.floats(10, 1e4), st.floats(1e3, 1e6))
def test_exact_frequencies_are_the_eigenvalues(m: float, w: float, t: float, kw: float, kc: float) -> None:
    system = ThreeMasses(m, w, t, kw, 0.0, kc)
    found = frequencies.exact(system)
    assert [found.low, found.high] == pytest.approx(list(eigenvalues(system)), rel=1e-6)


def test_eq_5_as_printed_is_not_the_frequency() -> None:
    assert frequencies.exact(CASE).low == pytest.approx(7.37, abs=0.005)
    assert frequencies.separated(CASE).low == pytest.approx(7.39, abs=0.005)
    reading = frequencies.printed_reading(CASE)
    assert reading.low == pytest.approx(frequencies.PRINTED_LOW_BRANCH, abs=0.05)
    low = eigenvalues(CASE)[0]
    assert low == pytest.approx(frequencies.exact(CASE).low, rel=1e-4)
    assert reading.low > 2.5 * low, "the printed form must not pass for the frequency"


def test_the_reading_of_eq_5_does_not_depend_on_the_slip_it_assumes() -> None:
    for spring in table1.SPRINGS:
        for target in table1.TARGET_MASSES:
            system = table1.three_masses(spring, target)
            a, b = frequencies.wrist_frequency(system) ** 2, frequencies.contact_frequency(system) ** 2
            x = frequencies.coupling(system)
            other = a * b / (2 - x)  # another slip in the same term with the same known number
            low = math.sqrt(0.5 * (a + b - math.sqrt((a + b) ** 2 - 4 * other)))
            assert frequencies.printed_reading(system).low == pytest.approx(low, rel=2e-3)


@pytest.mark.parametrize("hand_mass", [7.83, 1e9, math.inf])
def test_low_branch_tends_to_eqs_9_and_10_and_the_reading_does_not(hand_mass: float) -> None:
    base = dataclasses.replace(CASE, hand_mass=hand_mass)
    limit = math.sqrt(530.0 / reduction.reduced_mass(hand_mass, 9.7))
    assert frequencies.separated(base).low == pytest.approx(limit, rel=1e-12)
    gaps, wrong = [], []
    for stiffness in (1e5, 1e6, 1e7):
        system = dataclasses.replace(base, contact_stiffness=stiffness)
        gaps.append(abs(frequencies.exact(system).low - limit))
        wrong.append(abs(frequencies.printed_reading(system).low - limit))
    assert gaps[0] / gaps[1] == pytest.approx(10, rel=0.02)
    assert gaps[1] / gaps[2] == pytest.approx(10, rel=0.02)
    assert min(wrong) > 0.4 * limit


def test_the_separation_is_poor_at_the_stiffest_spring() -> None:
    ratio = frequencies.frequency_ratio(table1.three_masses(table1.SPRINGS[3], 51.0))
    assert ratio == pytest.approx(3.7, abs=0.05)


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.floats(0.1, 1e12), masses)
def test_eq_10_is_symmetric_and_below_both_masses(hand: float, lumped: float) -> None:
    m = reduction.reduced_mass(hand, lumped)
    assert m == pytest.approx(hand * lumped / (hand + lumped), rel=1e-12)
    assert m <= min(hand, lumped) * (1 + 1e-12)


def test_eq_10_tends_to_the_lumped_mass_at_first_order() -> None:
    assert reduction.reduced_mass(math.inf, 9.7) == 9.7
    gaps = [9.7 - reduction.reduced_mass(m, 9.7) for m in (1e4, 1e5, 1e6)]
    assert gaps[0] / gaps[1] == pytest.approx(10, rel=0.01)
    assert gaps[1] / gaps[2] == pytest.approx(10, rel=0.01)


def test_the_two_readings_of_the_damping() -> None:
    spring = table1.SPRINGS[0]
    plain = restitution.displacement_zero(table1.reduced(spring, 9.7, damping="wrist"))
    full = restitution.displacement_zero(table1.reduced(spring, 9.7))
    assert plain == pytest.approx(0.97, abs=0.005)
    assert full == pytest.approx(0.74, abs=0.005)
    with pytest.raises(ValueError, match="wrist\\+equivalent"):
        reduction.total_damping(1.0, 1.0, "all")  # type: ignore[arg-type]


def test_response_solves_eq_11_and_ends_at_eq_14() -> None:
    model = table1.reduced(table1.SPRINGS[0], 9.7)
    tau = contact_time.displacement_zero(model)
    assert model.damped_frequency * tau == pytest.approx(response.end_angle(), rel=1e-14)
    t = np.linspace(0, tau, 400)
    x, v, f = (g(model, 0.1, t) for g in (response.displacement, response.velocity, response.force))
    np.testing.assert_allclose(f, model.stiffness * x + model.damping * v, atol=1e-13 * f.max())
    np.testing.assert_allclose(np.gradient(x, t)[1:-1], v[1:-1], atol=1e-4 * 0.1)
    np.testing.assert_allclose(model.mass * np.gradient(v, t)[1:-1], -f[1:-1], atol=1e-3 * f.max())
    assert abs(x[-1]) < 1e-15
    assert -v[-1] / 0.1 == pytest.approx(restitution.displacement_zero(model), rel=1e-12)


@pytest.mark.parametrize("zeta", [0.01, 0.1, 0.45, 0.7])
def test_adhesion_before_the_end_of_eq_14(zeta: float) -> None:
    model = reduction.Reduced(9.7, 530.0, 2 * zeta * math.sqrt(9.7 * 530.0))
    found = response.adhesion(model, 0.1)
    assert abs(float(response.force(model, 0.1, found.start))) < 1e-12
    t = np.linspace(found.start, found.end, 20001)
    sampled = response.force(model, 0.1, t)
    assert (sampled[1:] < 0).all()
    assert found.peak_force == pytest.approx(-sampled.min(), rel=1e-7)
    assert 0 < found.share < 1
    before = response.force(model, 0.1, np.linspace(1e-9, found.start, 500)[:-1])
    assert (before > 0).all()
    assert found.peak_share == pytest.approx(found.peak_force / max(before.max(), zeta and before[0]), rel=1e-3)


def test_without_damping_nothing_pulls() -> None:
    model = reduction.Reduced(9.7, 530.0, 0.0)
    found = response.adhesion(model, 0.1)
    assert found.share == pytest.approx(0, abs=1e-15)
    assert found.peak_force < 1e-14


@pytest.mark.parametrize(("adhesive", "end"), [(True, "displacement_zero"), (False, "force_zero")])
def test_eqs_16_and_18_are_the_limit_of_the_exact_motion(adhesive: bool, end: kelvin_voigt.End) -> None:
    """First order in a stiff contact and a light wrist, for both end conditions."""
    model = reduction.Reduced(9.7, 530.0, 1.4)
    gaps = []
    for scale in (1.0, 10.0, 100.0):
        wrist, stiffness = 0.1 / scale, 68000.0 * scale
        damping = 2 * math.sqrt(stiffness * wrist)
        system = ThreeMasses(math.inf, wrist, 9.7 - wrist, 530.0, 1.4, stiffness, damping)
        motion = solve(system, 0.1, adhesive=adhesive, stop="returned" if adhesive else "duration")
        time = motion.end if adhesive else motion.contact_time
        rebound = -float(motion.state(motion.end)[5]) / 0.1
        gaps.append((time / contact_time.contact_time(model, end) - 1, rebound - restitution.restitution(model, end)))
    for coarse, fine in itertools.pairwise(gaps):
        assert coarse[0] / fine[0] == pytest.approx(10, rel=0.06)
        assert coarse[1] / fine[1] == pytest.approx(10, rel=0.06)
    assert max(map(abs, gaps[-1])) < 1e-4


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.floats(0.1, 1e6), masses, st.floats(-1, 1), st.floats(1e-3, 1), st.floats(0, 1))
def test_eq_19_keeps_momentum_and_eq_17(hand: float, lumped: float, vh: float, approach: float, e: float) -> None:
    vt = vh + approach
    after_h, after_t = restitution.velocities_after(hand, lumped, vh, vt, e)
    momentum = hand * vh + lumped * vt
    assert hand * after_h + lumped * after_t == pytest.approx(momentum, abs=1e-12 * (hand + lumped))
    measured = restitution.measured((vh, vh, vt), (after_h, after_h, after_t))
    assert measured.hand == pytest.approx(e, abs=1e-11 / approach)


def test_three_ways_to_measure_restitution() -> None:
    found = restitution.measured((0.0, 0.0, 0.1), (0.03, 0.01, -0.04))
    assert found == restitution.Measured(target=pytest.approx(0.4), hand=pytest.approx(0.7), point=pytest.approx(0.5))
    locked = restitution.velocities_after(math.inf, 9.7, 0.0, 0.1, 0.8)
    assert locked == (0.0, pytest.approx(-0.08))
    with pytest.raises(ValueError, match="approach"):
        restitution.measured((0.1, 0.1, 0.0), (0, 0, 0))
