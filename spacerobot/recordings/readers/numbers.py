"""Text to numbers, with the reason where a cell is none."""

from __future__ import annotations

import math
import re

LONGEST = 400
"""Most characters of a number: 309 digits before the point are the most that a double can need."""

_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?\Z")
_EMPTY = frozenset(
    {
        "",
        "nan",
        "na",
        "n/a",
        "null",
        "none",
        "-",
        "--",
        "inf",
        "+inf",
        "-inf",
        "-nan",
        "nan(ind)",
        "-nan(ind)",
    }
)
_GLUED = re.compile(r"[+-]?\d*\.\d+(?:[eE][+-]?\d+)?[+-]?\d*\.\d|[+-]?\d+\.?\d*[+-]\d+\.\d")


def number(cell: str, decimal: str = ".") -> float | None:
    """The cell's number; NaN for an empty or not finite one, None if it is no number."""
    text = cell.strip()
    if len(text) > LONGEST:
        return None
    if decimal == "," and "," in text:
        if "." in text:
            return None
        text = text.replace(",", ".")
    if _NUMBER.match(text):
        value = float(text)
        return value if math.isfinite(value) else math.nan
    return math.nan if text.lower() in _EMPTY else None


def reason(cell: str) -> str:
    """Why a cell is no number."""
    if len(cell) > LONGEST:
        return f"longer than a number can be ({len(cell)} characters)"
    if _GLUED.match(cell.strip()):
        return "two numbers run together: a separator is missing"
    if "," in cell:
        return "not a number (a decimal comma?)"
    return "not a number"
