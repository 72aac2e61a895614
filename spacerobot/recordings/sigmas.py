"""How well a lab knows what it believes: `[baseline.sigma]`, a share of the value or a size with its unit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.recordings import units
from spacerobot.recordings.document import Document, flatten
from spacerobot.recordings.values import kind
from spacerobot.support.errors import InputError

TURNING = {"N": ("force", "torque"), "m": ("length", "angle"), "rad": ("angle", "length")}
"""Units of a joint's values, which slide or turn -> what they may measure."""

TURNED = {"N s/m": "N m s/rad", "N/m": "N m/rad", "kg": "kg m2"}
"""Unit of a value of a joint that slides -> of one that turns."""


def read_sigma(
    document: Document, table: Mapping[str, Any], values: Mapping[str, float]
) -> tuple[dict[str, float], dict[str, float]]:
    """Relative standard deviations, and those of values that are believed to be zero, SI; by dotted name.

    `wrist.mass = 0.01` is a hundredth of the mass, `wrist.mass = "5 g"` five grams. A zero has no share, so that
    `joint.elbow.zero = "0.2 deg"` is the only way to say how well it is known; it is believed zero where the baseline
    does not state it.

    Raises:
        InputError: a negative number, another unit, a size of a value that is not stated, or a share of zero.
    """
    shares: dict[str, float] = {}
    sizes: dict[str, float] = {}
    for name, raw in flat(document, document.table(table, "sigma", "baseline"), "baseline", "sigma").items():
        where = document.where("baseline", "sigma", *name.split("."))
        known = kind(name, where=where)
        if not isinstance(raw, str):
            shares[name] = _share(document, "sigma", name, raw)
            if shares[name] > 0.0 and values.get(name) == 0.0:
                valid = f'a size with its unit, such as "0.1 {known.unit}"'
                raise InputError(f"{name} is 0, and a share of 0 is 0", given=raw, valid=valid, where=where)
            continue
        size = _size(raw, name, known.unit, where)
        if values.get(name):
            shares[name] = size / abs(values[name])
        elif name in values or known.minimum is None:
            sizes[name] = size
        else:
            raise InputError("a sigma with a unit needs the value itself", given=name, where=where)
    return shares, sizes


def relative(document: Document, table: Mapping[str, Any], key: str) -> dict[str, float]:
    """A table of relative standard deviations by dotted name."""
    found: dict[str, float] = {}
    for name, raw in flat(document, document.table(table, key, "baseline"), "baseline", key).items():
        kind(name, where=document.where("baseline", key, *name.split(".")))
        found[name] = _share(document, key, name, raw)
    return found


def flat(document: Document, table: Mapping[str, Any], *path: str) -> dict[str, Any]:
    """A table by dotted names."""
    try:
        return flatten(table)
    except InputError as error:
        raise InputError(error.what, given=error.given, where=document.where(*path)) from None


def _share(document: Document, key: str, name: str, raw: Any) -> float:
    number = document.number(raw, "baseline", key, name)
    if number < 0:
        raise InputError(
            f"{key} of {name} must not be negative",
            given=number,
            where=document.where("baseline", key, *name.split(".")),
        )
    return number


def _size(raw: str, name: str, unit: str, where: str) -> float:
    """A text such as "0.2 deg" in SI."""
    number, _, said = raw.strip().partition(" ")
    valid = f'a share of the value such as 0.01, or a size with its unit such as "0.1 {unit}"'
    try:
        size = float(number)
    except ValueError:
        raise InputError(f"sigma of {name} is no number with a unit", given=raw, valid=valid, where=where) from None
    if not 0.0 < size < float("inf"):
        raise InputError(f"sigma of {name} must be above 0", given=raw, valid=valid, where=where)
    said = said.strip()
    if said == unit or (name.startswith("joint.") and said == TURNED.get(unit)):
        return size
    measured: tuple[str, ...] = (units.UNITS[unit].dimension,) if unit in units.UNITS else ()
    if name.startswith("joint."):
        measured = TURNING.get(unit, measured)
    if not measured:
        raise InputError(
            f"sigma of {name} is in another unit", given=raw, valid=_either(number, name, unit), where=where
        )
    return size * units.factor(said, measured, where=where)


def _either(number: str, name: str, unit: str) -> str:
    """A size in the value's unit, of a joint that slides or turns."""
    turned = f' or "{number} {TURNED[unit]}"' if name.startswith("joint.") and unit in TURNED else ""
    return f'"{number} {unit}"{turned}'
