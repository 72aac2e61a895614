from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.theory import hunt_crossley as hc

from .integration import hit


@pytest.mark.parametrize(("n", "k", "mass"), [(1.0, 500.0, 2.0), (1.5, 4e4, 9.0), (2.3, 3e5, 0.7)])
@pytest.mark.parametrize("s", [0.01, 0.2, 1.5])
def test_agrees_with_integration_whatever_the_exponent(n: float, k: float, mass: float, s: float) -> None:
    v = 0.1
    chi = s * k / v
    # the force vanishes with the penetration: the end is d = 0
    reference = hit(lambda d, w: math.copysign(abs(d) ** n, d) * (k + chi * w), mass, v, "displacement_zero", 0.1)
    assert hc.restitution(chi, k, v) == pytest.approx(reference.restitution, rel=2e-7)


@pytest.mark.parametrize(("e", "s"), [(0.1, 9.998), (0.3, 3.087), (0.5, 1.433), (0.7, 0.635), (0.9, 0.1665)])
def test_exact_inversion(e: float, s: float) -> None:
    assert hc.dissipation_ratio(e) == pytest.approx(s, abs=6e-4)


@settings(max_examples=200, derandomize=True, deadline=None)
@given(st.floats(1e-4, 1.0))
def test_inverse_and_forward_are_one_equation(e: float) -> None:
    s = hc.dissipation_ratio(e)
    assert hc.restitution_of(s) == pytest.approx(e, rel=1e-11)


@pytest.mark.parametrize("s", [0.05, 0.3, 3.0, 30.0])
def test_solves_the_implicit_equation(s: float) -> None:
    e = hc.restitution_of(s)
    assert s * (1 + e) == pytest.approx(math.log((1 + s) / (1 - e * s)), rel=1e-11 if s < 20 else 1e-2)


def test_small_dissipation_keeps_its_digits() -> None:
    naive = (1 + _w(-(1 + 1e-6) * math.exp(-(1 + 1e-6)))) / 1e-6
    assert abs(naive - (1 - 2e-6 / 3)) > 1e-8, "the plain form is meant to be bad here"
    for s in (1e-12, 1e-9, 1e-6, 1e-3):
        assert hc.restitution_of(s) == pytest.approx(1 - 2 * s / 3 + 4 * s * s / 9, abs=max(s**3, 1e-15))
    below, above = hc.restitution_of(0.05 * (1 - 1e-12)), hc.restitution_of(0.05)
    assert below == pytest.approx(above, abs=1e-12)


def test_limits_and_rejections() -> None:
    assert hc.restitution_of(0.0) == 1.0
    assert hc.dissipation_ratio(1.0) == 0.0
    assert hc.dissipation_ratio(0.0) == math.inf
    assert hc.restitution_of(1e4) == pytest.approx(1e-4, rel=1e-12)
    assert hc.dissipation_for(0.5, 2e4, 0.1) == pytest.approx(1.43275 * 2e4 / 0.1, rel=1e-5)
    with pytest.raises(ValueError, match="restitution"):
        hc.dissipation_ratio(1.1)
    with pytest.raises(ValueError, match="stiffness"):
        hc.restitution(1.0, 0.0, 0.1)


def _w(x: float) -> float:
    from spacerobot.theory.special import lambert_w0

    return lambert_w0(x)
