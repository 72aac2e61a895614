"""Checks that every part of a scene makes of its values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from spacerobot.support.errors import InputError

LARGEST, SMALLEST = 1e12, 1e-12
"""No measure of a rig, in SI units, is beyond the one, and no positive one below the other."""


def number(value: Any, where: str, *, minimum: float | None = None, strict: bool = False) -> float:
    """`value` as a finite float, checked against its lower bound.

    Raises:
        InputError: no number, not finite, or below `minimum` (or at it, where `strict`).
    """
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        raise InputError("not a number", given=value, where=where)
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise InputError("not a finite number", given=found, where=where)
    if abs(found) > LARGEST or (strict and 0.0 < found < SMALLEST):
        raise InputError("out of range", given=found, valid=f"{SMALLEST:g} to {LARGEST:g}", where=where)
    if minimum is not None and (found < minimum or (strict and found == minimum)):
        what = "must be positive" if strict else "must not be negative"
        raise InputError(what if minimum == 0.0 else f"must be at least {minimum:g}", given=found, where=where)
    return found


def vector(value: Any, length: int | tuple[int, ...], where: str, valid: str = "") -> tuple[float, ...]:
    """`value` as a tuple of finite floats of one of the lengths.

    Raises:
        InputError: no list, of another length, or with something in it that is no finite number.
    """
    lengths = (length,) if isinstance(length, int) else length
    if isinstance(value, str | bytes | Mapping) or not isinstance(value, Sequence | np.ndarray):
        raise InputError("not a list of numbers", given=value, valid=valid or None, where=where)
    if len(value) not in lengths:
        counts = " or ".join(str(n) for n in lengths)
        raise InputError("wrong length", given=f"{len(value)} values", valid=valid or f"{counts} numbers", where=where)
    return tuple(number(v, f"{where}[{i}]") for i, v in enumerate(value))


def check_fields(record: object, where: str, **bounds: tuple[float, bool]) -> None:
    """Turn fields of a frozen record into floats, each checked against (lower bound, whether that is excluded).

    Raises:
        InputError: a field that is no finite number, or below its bound.
    """
    for name, (minimum, strict) in bounds.items():
        value = number(getattr(record, name), f"{where}.{name}", minimum=minimum, strict=strict)
        object.__setattr__(record, name, value)
