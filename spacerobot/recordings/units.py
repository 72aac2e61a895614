"""Units at the door: a small table of names, each with its dimension and its factor to SI."""

from __future__ import annotations

import math
from dataclasses import dataclass

from spacerobot.support.errors import InputError, NotFoundError


@dataclass(frozen=True)
class Unit:
    """A unit of measurement: SI value = factor * value.

    Attributes:
        name: as written in a study.
        dimension: e.g. "length", "angle", "force".
        factor: SI units per one of this unit.
    """

    name: str
    dimension: str
    factor: float


_POUND = 0.45359237  # kg, exact since 1959
_INCH = 0.0254  # m, exact
_GRAVITY = 9.80665  # m/s2, standard gravity, exact
_DEGREE = math.pi / 180.0

_TABLE: dict[str, dict[str, float]] = {
    "time": {
        "s": 1.0,
        "sec": 1.0,
        "ms": 1e-3,
        "us": 1e-6,
        "µs": 1e-6,
        "ns": 1e-9,
        "min": 60.0,
        "h": 3600.0,
        "d": 86400.0,
    },
    "length": {
        "m": 1.0,
        "km": 1e3,
        "dm": 1e-1,
        "cm": 1e-2,
        "mm": 1e-3,
        "um": 1e-6,
        "µm": 1e-6,
        "in": _INCH,
        "inch": _INCH,
        "ft": 12 * _INCH,
    },
    "angle": {
        "rad": 1.0,
        "mrad": 1e-3,
        "deg": _DEGREE,
        "°": _DEGREE,
        "rev": 2 * math.pi,
        "turn": 2 * math.pi,
    },
    "velocity": {
        "m/s": 1.0,
        "mm/s": 1e-3,
        "cm/s": 1e-2,
        "km/h": 1 / 3.6,
        "in/s": _INCH,
        "ft/s": 12 * _INCH,
    },
    "angular_velocity": {
        "rad/s": 1.0,
        "mrad/s": 1e-3,
        "deg/s": _DEGREE,
        "°/s": _DEGREE,
        "rpm": 2 * math.pi / 60,
        "rev/s": 2 * math.pi,
        "Hz": 2 * math.pi,
    },
    "acceleration": {"m/s2": 1.0, "m/s^2": 1.0, "mm/s2": 1e-3, "g0": _GRAVITY},
    "angular_acceleration": {"rad/s2": 1.0, "rad/s^2": 1.0, "deg/s2": _DEGREE},
    "mass": {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": _POUND, "oz": _POUND / 16},
    "force": {
        "N": 1.0,
        "mN": 1e-3,
        "cN": 1e-2,
        "daN": 10.0,
        "kN": 1e3,
        "MN": 1e6,
        "kgf": _GRAVITY,
        "kp": _GRAVITY,
        "gf": 1e-3 * _GRAVITY,
        "lbf": _POUND * _GRAVITY,
        "ozf": _POUND * _GRAVITY / 16,
    },
    "torque": {
        "Nm": 1.0,
        "N m": 1.0,
        "N*m": 1.0,
        "N.m": 1.0,
        "mNm": 1e-3,
        "Ncm": 1e-2,
        "Nmm": 1e-3,
        "N.mm": 1e-3,
        "N mm": 1e-3,
        "kNm": 1e3,
        "lbf in": _POUND * _GRAVITY * _INCH,
        "lbf ft": _POUND * _GRAVITY * 12 * _INCH,
    },
    "voltage": {"V": 1.0, "mV": 1e-3},
    "current": {"A": 1.0, "mA": 1e-3},
    "ratio": {"1": 1.0, "-": 1.0, "%": 1e-2},
}

UNITS: dict[str, Unit] = {
    name: Unit(name, dimension, factor) for dimension, table in _TABLE.items() for name, factor in table.items()
}
"""All known units by name. Case matters (mN is not MN); Hz counts turns when it measures a rotation."""

SI: dict[str, str] = {dimension: next(iter(table)) for dimension, table in _TABLE.items()}
"""The SI unit of each dimension."""


def unit(name: str, *, where: str | None = None) -> Unit:
    """The unit called `name`.

    Raises:
        NotFoundError: an unknown name, with the nearest known one.
    """
    found = UNITS.get(name.strip())
    if found is None:
        raise NotFoundError("unit", name, UNITS, where=where)
    return found


def factor(name: str, dimensions: tuple[str, ...], *, where: str | None = None) -> float:
    """SI units per one `name`, which must measure one of `dimensions`.

    Raises:
        InputError: an unknown unit, or one of another dimension.
    """
    found = unit(name, where=where)
    if found.dimension not in dimensions:
        valid = ", ".join(n for n, u in UNITS.items() if u.dimension in dimensions)
        raise InputError(
            f"a unit of {found.dimension} cannot measure {' or '.join(dimensions)}",
            given=name,
            valid=valid,
            where=where,
        )
    return found.factor
