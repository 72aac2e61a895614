"""Text to numbers, with the reason where a cell is none."""

from __future__ import annotations

import math
import re
from datetime import date

LONGEST = 400
"""Most characters of a number: 309 digits before the point are the most that a double can need."""

_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?\Z")
_STAMP = re.compile(
    r"(?:(?P<date>\d{4}([-/.])\d{1,2}\2\d{1,2}|\d{1,2}([./-])\d{1,2}\3\d{4})(?:[T_]| +))?"
    r"(?P<hour>\d{1,2}):(?P<minute>\d{2}):(?P<second>\d{2}(?:[.,]\d{1,9})?)(?P<zone>Z|[+-]\d{2}:?\d{2})?"
)
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
    return math.nan if text.lower() in _EMPTY else stamp(text)


def stamp(text: str) -> float | None:
    """Seconds since 1970 of a date with a time of day (UTC where no zone is stated), seconds of a time of day alone.

    Dates are year first, or day first with points; with strokes month first, unless no month has that number.
    """
    found = _STAMP.fullmatch(text)
    if found is None:
        return None
    hour, minute, second = int(found["hour"]), int(found["minute"]), float(found["second"].replace(",", "."))
    if hour > 23 or minute > 59 or second >= 61.0:
        return None
    seconds = 3600.0 * hour + 60.0 * minute + second
    if found["date"] is None:
        return seconds if found["zone"] is None else None
    first, middle, last = (int(n) for n in re.findall(r"\d+", found["date"]))
    if first > 31:
        year, month, day = first, middle, last
    elif "/" in found["date"]:
        year, month, day = (last, first, middle) if first <= 12 else (last, middle, first)
    else:
        year, month, day = last, middle, first
    try:
        days = date(year, month, day).toordinal() - date(1970, 1, 1).toordinal()
    except ValueError:
        return None
    zone = found["zone"] or "Z"
    away = 0.0
    if zone != "Z":
        turned = -1.0 if zone[0] == "-" else 1.0
        away = turned * (3600.0 * int(zone[1:3]) + 60.0 * int(zone[-2:]))
    return 86400.0 * days + seconds - away


def reason(cell: str) -> str:
    """Why a cell is no number."""
    if len(cell) > LONGEST:
        return f"longer than a number can be ({len(cell)} characters)"
    if _GLUED.match(cell.strip()):
        return "two numbers run together: a separator is missing"
    if "," in cell:
        return "not a number (a decimal comma?)"
    return "not a number"
