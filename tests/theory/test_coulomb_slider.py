from __future__ import annotations

import math

import pytest

from spacerobot.theory import coulomb_slider as cs
from spacerobot.theory import kelvin_voigt as kv

from .integration import hit

M, K, V = 9.7, 530.0, 0.1
ROOT = math.sqrt(M * K)


@pytest.mark.parametrize("end", kv.ENDS)
@pytest.mark.parametrize("zeta", [0.0, 0.02, 0.3])
@pytest.mark.parametrize("phi", [0.0, 0.05, 0.15])
def test_agrees_with_integration(phi: float, zeta: float, end: kv.End) -> None:
    friction, c = phi * V * ROOT, 2 * zeta * ROOT
    reference = hit(lambda x, v: K * x + c * v + math.copysign(friction, v), M, V, end, 1.0)
    found = cs.rebound(M, K, friction, V, damping=c, end=end)
    assert found.peak_deflection == pytest.approx(reference.peak_deflection, rel=1e-10)
    assert found.contact_time == pytest.approx(reference.time, rel=1e-9)
    assert found.restitution == pytest.approx(reference.restitution, rel=1e-9)


@pytest.mark.parametrize("phi", [0.01, 0.1, 0.3])
def test_undamped_forms(phi: float) -> None:
    friction = phi * V * ROOT
    for end in kv.ENDS:
        assert cs.rebound(M, K, friction, V, end=end).restitution == pytest.approx(
            cs.restitution_undamped(phi, end), rel=1e-13
        )
    released = cs.rebound(M, K, friction, V, end="force_zero")
    assert released.contact_time * math.sqrt(K / M) == pytest.approx(math.atan2(1, phi) + math.pi / 2, rel=1e-14)
    x = V / math.sqrt(K / M) * (math.sqrt(1 + phi * phi) - phi)
    assert released.peak_deflection == pytest.approx(x, rel=1e-13)


def test_the_two_ends_at_phi_0_3() -> None:
    assert cs.restitution_undamped(0.3, "force_zero") == pytest.approx(0.444, abs=5e-4)
    assert cs.restitution_undamped(0.3) == pytest.approx(0.327, abs=5e-4)


@pytest.mark.parametrize("end", kv.ENDS)
def test_below_the_smallest_speed_nothing_comes_back(end: kv.End) -> None:
    v = cs.smallest_speed(M, K, 0.5, end)
    assert cs.rebound(M, K, 0.5, v * (1 + 1e-9), end=end).restitution > 0
    stays = cs.rebound(M, K, 0.5, v * (1 - 1e-9), end=end)
    assert (stays.restitution, stays.contact_time) == (0.0, math.inf)


def test_without_friction_it_is_kelvin_voigt() -> None:
    for end in kv.ENDS:
        found = cs.rebound(M, K, 0.0, V, damping=5.0, end=end)
        assert found.restitution == pytest.approx(kv.restitution(M, K, 5.0, end), rel=1e-13)
        assert found.contact_time == pytest.approx(kv.contact_time(M, K, 5.0, end), rel=1e-13)
        assert found.peak_deflection == pytest.approx(kv.peak_deflection(M, K, 5.0, V), rel=1e-13)


def test_restitution_rises_with_speed_and_the_equivalent_damping_does_not_follow() -> None:
    friction = cs.equivalent_friction(12.3, V)
    assert cs.equivalent_damping(friction, V) == pytest.approx(12.3, rel=1e-14)
    speeds = [0.05, 0.1, 0.2]
    e = [cs.rebound(M, K, friction, v, damping=1.4).restitution for v in speeds]
    constant = kv.restitution(M, K, 1.4 + 12.3)
    assert e[0] < e[1] < e[2]
    assert abs(e[1] - constant) < 0.04, "at its own speed the constant stands in for the friction"
    assert e[0] < constant - 0.2
    assert e[2] > constant + 0.08


def test_rejections() -> None:
    with pytest.raises(ValueError, match="damping ratio"):
        cs.rebound(M, K, 0.1, V, damping=3 * ROOT)
    with pytest.raises(ValueError, match="speed"):
        cs.rebound(M, K, 0.1, 0.0)
    with pytest.raises(ValueError, match="end"):
        cs.rebound(M, K, 0.1, V, end="soon")  # type: ignore[arg-type]
