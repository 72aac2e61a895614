"""Rows of decimal numbers at a compiled loop's speed, each to the double nearest to it, as `float` reads it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spacerobot.recordings.table import Floats
from spacerobot.support.jit import jit, part

LINES = 50_000
"""Lines that are parsed at a time, which bounds the memory that they take besides their own."""

_TEN = 10.0 ** np.arange(23)
"""Powers of ten that a double holds exactly."""

_MOST = 19
"""Digits that always fit into 64 bits."""

_SPLIT = 134217729.0  # 2^27 + 1, Dekker 1971: halves of a double whose products are exact
_DOUBT = 2.0**-48
"""Relative error of a quotient's remainder, sixteen times over what its four roundings can make."""


def decimals(lines: Sequence[str], separator: str, width: int) -> Floats | None:
    """The numbers of `lines`, (len(lines), width); None where a line is anything but `width` decimal numbers.

    Args:
        lines: without their ends.
        separator: one ASCII character; " " stands for any run of blanks.
        width: numbers of a line.
    """
    if not width or not separator.isascii():
        return None
    values = np.empty((len(lines), width))
    for first in range(0, len(lines), LINES):
        part = lines[first : first + LINES]
        text = np.frombuffer("\n".join(part).encode("utf-8", "replace") + b"\n", dtype=np.uint8)
        if not _rows(text, ord(separator), values[first : first + len(part)]):
            return None
        for row, column in np.argwhere(np.isnan(values[first : first + len(part)])).tolist():
            cell = part[row].split(None if separator == " " else separator)[column]
            values[first + row, column] = float(cell)
    return values if np.isfinite(values).all() else None


@jit
def _rows(text: np.ndarray, separator: int, values: np.ndarray) -> bool:
    """Fill `values`, shape (rows, width), with NaN where `float` must decide; whether all cells are numbers."""
    at = 0
    blank = separator == 32
    rows, width = values.shape
    for row in range(rows):
        for column in range(width):
            while text[at] == 32 or (text[at] == 9 and separator != 9):
                at += 1
            negative = text[at] == 45
            if negative or text[at] == 43:
                at += 1
            digits, kept, fraction = 0, 0, 0
            whole = np.uint64(0)
            point = False
            while True:
                c = text[at]
                if 48 <= c <= 57:
                    digits += 1
                    fraction += point
                    if kept or c != 48:
                        kept += 1
                        if kept <= _MOST:
                            whole = whole * np.uint64(10) + np.uint64(c - 48)
                elif c == 46 and not point:
                    point = True
                else:
                    break
                at += 1
            if digits == 0:
                return False
            power = 0
            if text[at] == 101 or text[at] == 69:
                at += 1
                down = text[at] == 45
                if down or text[at] == 43:
                    at += 1
                if not 48 <= text[at] <= 57:
                    return False
                while 48 <= text[at] <= 57:
                    power = min(10 * power + text[at] - 48, 100000)
                    at += 1
                if down:
                    power = -power
            value = np.nan if kept > _MOST else _nearest(whole, power - fraction)
            values[row, column] = -value if negative else value
            ended = at
            while text[at] == 32 or (text[at] == 9 and separator != 9):
                at += 1
            if column == width - 1:
                if text[at] != 10:
                    return False
                at += 1
            elif blank:
                if at == ended:
                    return False
            elif text[at] == separator:
                at += 1
            else:
                return False
    return at == text.size


@part
def _nearest(whole: int, power: int) -> float:
    """The double nearest to whole 10^power; NaN where this arithmetic cannot tell which it is."""
    high = float(whole)
    if whole == 0:
        return 0.0
    if not -22 <= power <= 22:
        return np.nan
    if whole <= np.uint64(9007199254740992):  # 2^53: both are exact, so one operation rounds right (Clinger 1990)
        return high * _TEN[power] if power >= 0 else high / _TEN[-power]
    if power >= 0:
        return high if power == 0 else np.nan
    ten = _TEN[-power]
    quotient = high / ten
    a = _SPLIT * quotient
    a -= a - quotient
    b = _SPLIT * ten
    b -= b - ten
    product = quotient * ten
    error = ((a * b - product) + a * (ten - b) + (quotient - a) * b) + (quotient - a) * (ten - b)
    low = float(np.int64(whole - np.uint64(high)))
    rest = ((high - product) - error + low) / ten
    value = quotient + rest * (1.0 + _DOUBT)
    return value if value == quotient + rest * (1.0 - _DOUBT) else np.nan
