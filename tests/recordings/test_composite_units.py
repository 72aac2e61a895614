"""A unit that is written as a product or a quotient of others is that product: nobody typed its factor wrong."""

from __future__ import annotations

import math
import re

import pytest

from spacerobot.recordings.units import UNITS

GRAVITY = 9.80665
BASES = {
    # time, length, angle, mass
    "s": 1.0, "sec": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0,
    "m": 1.0, "in": 0.0254, "inch": 0.0254, "ft": 0.3048,
    "rad": 1.0, "deg": math.pi / 180, "°": math.pi / 180, "rev": 2 * math.pi, "turn": 2 * math.pi,
    "g": 1e-3, "t": 1e3, "lb": 0.45359237, "oz": 0.45359237 / 16,
    # named ones
    "N": 1.0, "gf": 1e-3 * GRAVITY, "kp": GRAVITY, "lbf": 0.45359237 * GRAVITY, "ozf": 0.45359237 / 16 * GRAVITY,
    "g0": GRAVITY,
    "V": 1.0, "A": 1.0, "rpm": 2 * math.pi / 60, "Hz": 2 * math.pi, "1": 1.0, "-": 1.0, "%": 0.01,
}  # fmt: skip
PREFIXES = {"n": 1e-9, "u": 1e-6, "µ": 1e-6, "m": 1e-3, "c": 1e-2, "d": 0.1, "da": 10.0, "k": 1e3, "M": 1e6}


def simple(name: str) -> float | None:
    """A base, with a prefix or without."""
    if name in BASES:
        return BASES[name]
    for prefix, factor in PREFIXES.items():
        if name.startswith(prefix) and name.removeprefix(prefix) in BASES:
            return factor * BASES[name.removeprefix(prefix)]
    return None


def product(name: str) -> float | None:
    """A name read as a product of bases: N m, N*m, N.m, Nm, lbf in, mm/s2, km/h."""
    above, _, below = name.partition("/")
    found = factors(above)
    if found is None or not below:
        return found
    powered = re.fullmatch(r"(\w+?)\^?([23]?)", below)
    divisor = simple(powered[1]) if powered else None
    return None if divisor is None else found / divisor ** int(powered[2] or 1)


def factors(text: str) -> float | None:
    known = simple(text)
    if known is not None:
        return known
    parts = re.split(r"[ *.]", text)
    if len(parts) == 1:  # Nm, Ncm, mNm: a force, then a length
        parts = next(
            ([text[:k], text[k:]] for k in range(1, len(text)) if text[k - 1] in "Nf" and simple(text[k:])), []
        )
    found = [simple(p) for p in parts]
    return math.prod(f for f in found if f) if found and all(found) else None


@pytest.mark.parametrize("name", UNITS)
def test_every_unit_is_the_product_of_its_bases(name: str) -> None:
    assert UNITS[name].factor == pytest.approx(product(name), rel=1e-14)


DIMENSIONS = {
    "velocity": ("length", "time", 1),
    "acceleration": ("length", "time", 2),
    "angular_velocity": ("angle", "time", 1),
    "angular_acceleration": ("angle", "time", 2),
}


def test_quotients_measure_what_they_divide() -> None:
    for name, unit in UNITS.items():
        above, _, below = name.partition("/")
        if below:
            what, by, power = DIMENSIONS[unit.dimension]
            assert UNITS[above].dimension == what
            assert UNITS[below.rstrip("^23")].dimension == by
            assert int(re.sub(r"\D", "", below) or 1) == power
