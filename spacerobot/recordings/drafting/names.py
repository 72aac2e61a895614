"""What a file's name says: words, numbers, dates, and values with a unit (`run1_12.5kg`)."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from pathlib import PurePath

from spacerobot.recordings.drafting.languages import STROKES, english
from spacerobot.recordings.drafting.vocabulary import QUANTITIES, THINGS
from spacerobot.recordings.units import UNITS

ENDINGS = (
    ".csv", ".tsv", ".txt", ".dat", ".log", ".asc", ".mat", ".h5", ".hdf5", ".npz", ".npy", ".bag", ".mcap", ".db3",
    ".xlsx", ".lvm", ".prn", ".trc", ".sto", ".mot", ".out", ".gz", ".bz2", ".xz",
)  # fmt: skip
"""Endings of files that may be recordings; a file without any, or with a number for one, may be one too."""

_DATE = re.compile(r"(?:19|20)\d\d([-_. ]?)(?:0?[1-9]|1[0-2])\1(?:0[1-9]|[12]\d|3[01]|[1-9])(?![0-9])")
_SPLIT = re.compile(r"[_\s,+=()\[\]]+|-|(?<!\d)\.|\.(?!\d)")
_VALUE = re.compile(r"([^\W\d_]*)(\d+(?:[.p]\d+)?)([A-Za-zµ/]+)", re.IGNORECASE)
_OF_A_MACHINE = re.compile(r"(joint|axis|motor)\s*(\d{1,2})")
"""What is one of several on the same machine: its number tells no trial from another."""
_COMMA = re.compile(r"(?<![A-Za-z0-9.,])(\d+),(\d+)(?=[A-Za-zµ])")
"""A decimal comma: between digits, before a unit."""

_KILOGRAMS = re.compile(r"(?<=\d)\s+(?=kg(?![A-Za-z]))", re.IGNORECASE)
"""A blank between a mass and its unit."""


_MASS = ("", "m", "mass")

_OF_A_THING = QUANTITIES.union(*THINGS.values())
"""Words of folders that keep one thing's files, and so tell no trial: target/, wrist_encoder/."""


@dataclass(frozen=True)
class Named:
    """The parts of a file's name.

    Attributes:
        words: what holds no digit, in lower case, and the joint that the file is of ("joint2").
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
        measured = QUANTITIES.intersection(tokens) or _OF_A_THING.issuperset(tokens)
        measured = measured and not any(c.isdigit() for c in part)
        (words if measured else folders).extend(tokens if measured else [part])
        values.extend(value for token in _tokens(part) if (value := _value(token)) is not None)
    keys.extend(folders)
    stem = without_ending(relative.name)
    keys.extend(date.group(0) for date in _DATE.finditer(stem))
    for token in _tokens(_DATE.sub("_", stem)):
        if (value := _value(token)) is not None:
            values.append(value)
        elif own := _OF_A_MACHINE.fullmatch(english(token).lower().strip()):
            words.append(f"joint{int(own.group(2))}")
        elif any(c.isdigit() for c in token):
            keys.append(token)
        else:
            words.extend(english(token).lower().split())
    return Named(tuple(words), tuple(keys), tuple(values))


def _tokens(text: str) -> list[str]:
    return [t for t in _SPLIT.split(_COMMA.sub(r"\1.\2", _KILOGRAMS.sub("", text))) if t]


def _value(token: str) -> tuple[str, float, str] | None:
    """A mass that the token states, None where it states none that a body can have."""
    found = _VALUE.fullmatch(token)
    unit = UNITS.get(found.group(3)) if found else None
    if found is None or unit is None or unit.dimension != "mass" or english(found.group(1)).lower() not in _MASS:
        return None
    number = float(found.group(2).lower().replace("p", "."))
    return (token, number, unit.name) if number > 0.0 else None


def is_measured(word: str) -> bool:
    """Whether a word of a file's name says what the file measures."""
    return word in QUANTITIES or (word.startswith("joint") and word[5:].isdigit())


def same(key: str) -> str:
    """`key` as it is compared: "01", "1" and "run1" are one number, a date is itself."""
    if _DATE.fullmatch(key):
        return key
    digits = re.findall(r"\d+", key)
    return str(int(digits[0])) if len(digits) == 1 and len(digits[0]) < 9 else key.lower()


def identifier(text: str) -> str:
    """`text` as the id of a trial."""
    return re.sub(r"[^\w.+=-]+", "_", in_ascii(text), flags=re.ASCII).strip("._ ")[:60]


def in_ascii(text: str) -> str:
    """`text` with Latin letters without their accents; other scripts stay as they are."""
    parts = unicodedata.normalize("NFKD", text.replace("ß", "ss").replace("æ", "ae").translate(STROKES))
    return unicodedata.normalize("NFC", "".join(c for c in parts if not unicodedata.combining(c)))
