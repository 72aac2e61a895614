"""Units against their definitions."""

from __future__ import annotations

import math

import pytest

from spacerobot.recordings.units import SI, UNITS, factor, unit
from spacerobot.support.errors import InputError, NotFoundError


@pytest.mark.parametrize(
    ("name", "dimension", "expected"),
    [
        ("mm", "length", 1e-3),
        ("in", "length", 0.0254),
        ("deg", "angle", math.pi / 180),
        ("rpm", "angular_velocity", 2 * math.pi / 60),
        ("ms", "time", 1e-3),
        ("g", "mass", 1e-3),
        ("oz", "mass", 0.028349523125),
        ("lbf", "force", 4.4482216152605),
        ("kgf", "force", 9.80665),
        ("lbf ft", "torque", 1.3558179483314004),
        ("km/h", "velocity", 1 / 3.6),
    ],
)
def test_factor(name: str, dimension: str, expected: float) -> None:
    assert factor(name, (dimension,)) == pytest.approx(expected, rel=1e-14)


def test_every_dimension_has_its_si_unit_with_factor_one() -> None:
    for dimension, name in SI.items():
        assert UNITS[name].dimension == dimension
        assert UNITS[name].factor == 1.0


def test_no_name_means_two_units() -> None:
    assert all(unit(name).name == name for name in UNITS)


def test_unknown_unit_names_the_nearest() -> None:
    with pytest.raises(NotFoundError, match="did you mean 'rpm'"):
        unit("rmp")


def test_wrong_dimension_is_refused() -> None:
    with pytest.raises(InputError, match="cannot measure length"):
        factor("N", ("length",))
