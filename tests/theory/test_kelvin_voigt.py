from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.theory import kelvin_voigt as kv

from .integration import hit

M, K, V = 9.7, 530.0, 0.1
CRITICAL = 2 * math.sqrt(M * K)


@pytest.mark.parametrize("end", kv.ENDS)
@pytest.mark.parametrize("zeta", [0.0, 0.01, 0.095, 0.4, 0.7, 0.95])
def test_agrees_with_integration(zeta: float, end: kv.End) -> None:
    c = zeta * CRITICAL
    reference = hit(lambda x, v: K * x + c * v, M, V, end, 1.0)
    assert kv.contact_time(M, K, c, end) == pytest.approx(reference.time, rel=1e-10)
    assert kv.restitution(M, K, c, end) == pytest.approx(reference.restitution, rel=1e-10)
    assert kv.peak_deflection(M, K, c, V) == pytest.approx(reference.peak_deflection, rel=1e-10)
    assert kv.peak_force(M, K, c, V) == pytest.approx(reference.peak_force, rel=1e-6)


@pytest.mark.parametrize("zeta", [1.0, 1.5, 3.0])
def test_overdamped_contact_lets_go_where_the_force_vanishes(zeta: float) -> None:
    c = zeta * CRITICAL
    reference = hit(lambda x, v: K * x + c * v, M, V, "force_zero", 1.0)
    assert kv.contact_time(M, K, c, "force_zero") == pytest.approx(reference.time, rel=1e-9)
    assert kv.restitution(M, K, c, "force_zero") == pytest.approx(reference.restitution, rel=1e-9)
    assert kv.contact_time(M, K, c) == math.inf
    assert kv.restitution(M, K, c) == 0.0


def test_critical_damping_has_its_own_limits() -> None:
    assert kv.contact_time(M, K, CRITICAL, "force_zero") == pytest.approx(2 / math.sqrt(K / M), rel=1e-14)
    assert kv.restitution(M, K, CRITICAL, "force_zero") == pytest.approx(math.exp(-2), rel=1e-14)
    for side in (1 - 1e-6, 1 + 1e-6):
        near = kv.restitution(M, K, side * CRITICAL, "force_zero")
        assert near == pytest.approx(math.exp(-2), rel=1e-5)
        assert near != math.exp(-2)


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.floats(0.02, 1.0), st.sampled_from(kv.ENDS))
def test_damping_for_restitution_inverts_restitution(e: float, end: kv.End) -> None:
    c = kv.damping_for_restitution(e, M, K, end)
    assert kv.restitution(M, K, c, end) == pytest.approx(e, rel=1e-11)


def test_the_two_ends_differ_as_soon_as_there_is_damping() -> None:
    assert kv.contact_time(M, K, 0.0, "force_zero") == kv.contact_time(M, K, 0.0)
    assert kv.contact_time(M, K, 13.7, "force_zero") < 0.95 * kv.contact_time(M, K, 13.7)
    assert kv.restitution(M, K, 13.7, "force_zero") > 1.01 * kv.restitution(M, K, 13.7)


def test_swapped_end_conditions_would_be_caught() -> None:
    c = 0.095 * CRITICAL
    reference = hit(lambda x, v: K * x + c * v, M, V, "force_zero", 1.0)
    assert kv.contact_time(M, K, c, "displacement_zero") != pytest.approx(reference.time, rel=1e-3)


@pytest.mark.parametrize("bad", [{"mass": 0.0}, {"stiffness": -1.0}, {"damping": -1.0}, {"mass": math.nan}])
def test_rejects_what_is_no_hit(bad: dict[str, float]) -> None:
    arguments = {"mass": M, "stiffness": K, "damping": 1.0} | bad
    with pytest.raises(ValueError, match=next(iter(bad))):
        kv.restitution(**arguments)


def test_rejects_unknown_end_and_restitution() -> None:
    with pytest.raises(ValueError, match="displacement_zero"):
        kv.contact_time(M, K, 1.0, "never")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="restitution"):
        kv.damping_for_restitution(0.0, M, K)


@pytest.mark.parametrize("gap", [9e-7, -9e-7, 1.1e-6, -1.1e-6, 1e-9])
def test_near_critical_damping_the_duration_keeps_all_its_digits(gap: float) -> None:
    """acos(z) = 2 asin sqrt((1 - z) / 2) and 1 - z^2 = (1 - z)(1 + z), which lose none."""
    zeta = 1.0 - gap
    exact = 1.0 - zeta
    half = math.sqrt(abs(exact) / 2.0)
    angle = 2.0 * (math.asin(half) if exact > 0.0 else math.asinh(half))
    expected = 2.0 * angle / math.sqrt(abs(exact) * (2.0 - exact))
    assert kv.contact_time(1.0, 1.0, 2.0 * zeta, "force_zero") == pytest.approx(expected, rel=1e-9)
