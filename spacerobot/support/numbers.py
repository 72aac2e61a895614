"""Lists of numbers as people type them: spaces or commas between, degrees or radians, JOINT=VALUE pairs."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

from spacerobot.support.errors import InputError

_BETWEEN = re.compile(r"[\s,;]+")


def parse_numbers(
    tokens: str | Iterable[str], what: str, *, count: int | None = None, names: Sequence[str] = ()
) -> list[float]:
    """Finite numbers from text such as `["0", "45,", "-1e-3"]` or `"0,45,-1e-3"`.

    Args:
        tokens: one text or several; brackets around the list are ignored.
        what: what the numbers are, for the error message ("--q").
        count: how many there must be; any number if None.
        names: what each number stands for, listed in the error message.

    Returns:
        list of floats, in the order given.

    Raises:
        InputError: not a number, not finite, or not `count` of them.
    """
    text = tokens if isinstance(tokens, str) else " ".join(tokens)
    parts = [part for part in _BETWEEN.split(text.strip().strip("[]()")) if part]
    values = []
    for part in parts:
        try:
            value = float(part)
        except ValueError:
            raise InputError(f"{what}: not a number", given=part, valid="numbers such as -1e-3") from None
        if not math.isfinite(value):
            raise InputError(f"{what}: not a finite number", given=part)
        values.append(value)
    if count is not None and len(values) != count:
        listed = f", one each for {', '.join(names)}" if names else ""
        raise InputError(
            f"{what}: wrong length",
            given=f"{len(values)} numbers ({text.strip()})",
            valid=f"{count} numbers{listed}",
        )
    return values


def parse_whole(text: str, what: str, *, least: int = 0, most: int = 2**62) -> int:
    """A whole number from text.

    Raises:
        InputError: not a whole number, or below `least` or above `most`.
    """
    try:
        value = int(text)
    except ValueError:
        value = least - 1
    if not least <= value <= most:
        raise InputError("not a number that serves here", given=text, valid=f"a whole number from {least}", where=what)
    return value


def parse_assignments(tokens: Iterable[str], what: str) -> dict[str, float]:
    """`NAME=VALUE` texts as a dictionary; several may be joined by commas.

    Raises:
        InputError: no equals sign, no name, a value that is no finite number, or a name given twice.
    """
    found: dict[str, float] = {}
    for token in (part for text in tokens for part in re.split(r"[\s,]+", text) if part):
        name, equals, value = token.partition("=")
        if not equals or not name:
            raise InputError(f"{what}: cannot be read", given=token, valid="NAME=VALUE")
        if name in found:
            raise InputError(f"{what}: {name} is set twice", given=token)
        found[name] = parse_numbers(value, f"{what} {name}", count=1)[0]
    return found


def to_radians(values: Sequence[float], angular: Sequence[bool]) -> list[float]:
    """Degrees to radians where `angular` says that the value is an angle; lengths pass unchanged."""
    return [math.radians(v) if a else v for v, a in zip(values, angular, strict=True)]
