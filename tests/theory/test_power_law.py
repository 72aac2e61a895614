from __future__ import annotations

import math

import pytest

from spacerobot.theory import kelvin_voigt as kv
from spacerobot.theory import power_law as pl

from .integration import hit


@pytest.mark.parametrize("n", [1.0, 1.5, 2.2])
def test_agrees_with_integration(n: float) -> None:
    reference = hit(lambda d, v: 4e4 * math.copysign(abs(d) ** n, d), 9.0, 0.1, "displacement_zero", 0.1)
    assert pl.contact_time(9.0, 4e4, 0.1, n) == pytest.approx(reference.time, rel=1e-7)
    assert pl.peak_deflection(9.0, 4e4, 0.1, n) == pytest.approx(reference.peak_deflection, rel=1e-9)
    assert pl.peak_force(9.0, 4e4, 0.1, n) == pytest.approx(reference.peak_force, rel=1e-7)


def test_hertz() -> None:
    assert pl.contact_time(2.0, 3.0, 5.0) * 5.0 / pl.peak_deflection(2.0, 3.0, 5.0) == pytest.approx(2.9433, abs=5e-5)
    ratio = pl.contact_time(2.0, 3.0, 10.0) / pl.contact_time(2.0, 3.0, 5.0)
    assert ratio == pytest.approx(2 ** (-1 / 5), rel=1e-13)


def test_exponent_one_is_the_linear_spring() -> None:
    assert pl.contact_time(2.0, 30.0, 5.0, 1.0) == pytest.approx(kv.contact_time(2.0, 30.0, 0.0), rel=1e-14)
    with pytest.raises(ValueError, match="exponent"):
        pl.contact_time(2.0, 30.0, 5.0, -1.0)
