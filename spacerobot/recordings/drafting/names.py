"""What a file's name says: words, numbers, dates, and values with a unit (`run1_12.5kg`)."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import PurePath

from spacerobot.recordings.drafting.vocabulary import QUANTITIES
from spacerobot.recordings.units import UNITS

ENDINGS = (
    ".csv", ".tsv", ".txt", ".dat", ".log", ".asc", ".mat", ".h5", ".hdf5", ".npz", ".npy", ".bag", ".mcap", ".db3",
    ".xlsx", ".gz", ".bz2", ".xz",
)  # fmt: skip
"""Endings of files that may be recordings; a file without any, or with a number for one, may be one too."""

_DATE = re.compile(r"(?:19|20)\d\d([-_. ]?)(?:0?[1-9]|1[0-2])\1(?:0[1-9]|[12]\d|3[01]|[1-9])(?![0-9])")
_SPLIT = re.compile(r"[_\s,+=()\[\]]+|-|(?<!\d)\.|\.(?!\d)")
_VALUE = re.compile(r"(\d+(?:[.p]\d+)?)([A-Za-zµ/]+)")


@dataclass(frozen=True)
class Named:
    """The parts of a file's name.

    Attributes:
        words: what holds no digit, in lower case.
        keys: folders (but for those that say what is measured), then what holds a digit, without values; dates in
            one piece.
        values: (text, number, unit) of numbers with a unit of mass.
    """

    words: tuple[str, ...]
    keys: tuple[str, ...]
    values: tuple[tuple[str, float, str], ...]


def without_ending(name: str) -> str:
    """`name` without the endings that say what kind of file it is."""
    while (end := PurePath(name).suffix.lower()) in ENDINGS:
        name = name[: -len(end)]
    return name


def named(relative: PurePath) -> Named:
    """The parts of the path `relative` to the folder of the recordings."""
    words: list[str] = []
    keys: list[str] = []
    values: list[tuple[str, float, str]] = []
    folders: list[str] = []
    for part in relative.parts[:-1]:
        tokens = [t.lower() for t in _SPLIT.split(part) if t]
        measured = QUANTITIES.intersection(tokens) and not any(c.isdigit() for c in part)
        (words if measured else folders).extend(tokens if measured else [part])
    keys.extend(folders)
    stem = without_ending(relative.name)
    keys.extend(date.group(0) for date in _DATE.finditer(stem))
    for token in filter(None, _SPLIT.split(_DATE.sub("_", stem))):
        value = _VALUE.fullmatch(token)
        unit = UNITS.get(value.group(2)) if value else None
        if value and unit is not None and unit.dimension == "mass":
            values.append((token, float(value.group(1).replace("p", ".")), unit.name))
        elif any(c.isdigit() for c in token):
            keys.append(token)
        else:
            words.append(token.lower())
    return Named(tuple(words), tuple(keys), tuple(values))


def same(key: str) -> str:
    """`key` as it is compared: "01", "1" and "run1" are one number, a date is itself."""
    if _DATE.fullmatch(key):
        return key
    digits = re.findall(r"\d+", key)
    return str(int(digits[0])) if len(digits) == 1 and len(digits[0]) < 9 else key.lower()


def identifier(text: str) -> str:
    """`text` as the id of a trial."""
    return re.sub(r"[^\w.+=-]+", "_", text, flags=re.ASCII).strip("._ ")[:60]
