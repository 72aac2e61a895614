"""The checks that the closed forms make of their arguments."""

from __future__ import annotations

import math


def positive(**values: float) -> None:
    """Refuse anything that is not a finite number above zero.

    Raises:
        ValueError: names the argument and what was given.
    """
    for name, value in values.items():
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be a finite number above zero; given: {value!r}")


def not_negative(**values: float) -> None:
    """Refuse anything that is not a finite number of zero or more.

    Raises:
        ValueError: names the argument and what was given.
    """
    for name, value in values.items():
        if not (math.isfinite(value) and value >= 0):
            raise ValueError(f"{name} must be a finite number of zero or more; given: {value!r}")


def mass_or_locked(**values: float) -> None:
    """Refuse a mass that is neither above zero nor infinite (a locked body).

    Raises:
        ValueError: names the argument and what was given.
    """
    for name, value in values.items():
        if math.isnan(value) or value <= 0:
            raise ValueError(f"{name} must be above zero, or infinite for a locked body; given: {value!r}")
