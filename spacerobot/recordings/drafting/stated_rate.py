"""Readings a second that a file states above its table: motion capture counts frames and says their rate once."""

from __future__ import annotations

import re
from pathlib import Path

from spacerobot.recordings.drafting.masses import HEAD
from spacerobot.recordings.readers.numbers import number
from spacerobot.recordings.readers.text import read_lines
from spacerobot.support.errors import InputError

_SAID = re.compile(
    r"\W*(?:(?:capture|sample|sampling|frame|export|data|camera|video|abtast)[ _-]?)*"
    r"(?:rate|frequency|freq|frequenz|fps|fs|samplerate|framerate)\W*(?:\[?\(?hz\]?\)?)?"
    r"\s*[:=;,\t ]\s*[\"']?(?P<rate>\d+(?:[.,]\d+)?)\s*(?:hz|fps)?\W*",
    re.IGNORECASE,
)
"""A line that says nothing else: "FREQUENCY\t250", "Sampling rate [Hz]; 1000"."""

_SECTION = re.compile(r"\W*(?:trajectories|devices|segments|joints|model outputs)\W*", re.IGNORECASE)
"""First line of an export whose second is its rate alone."""

_BARE = re.compile(r"\W*(?P<rate>\d+(?:\.\d+)?)\W*")

FASTEST = 1e5
"""No sensor of a rig is read more often [Hz]."""


def stated_rate(path: Path) -> float | None:
    """The rate above a text file's table [Hz]; None where none is stated, or two are."""
    try:
        lines = read_lines(path)[:HEAD]
    except InputError:
        return None
    found = {rate for line in lines if (match := _SAID.fullmatch(line)) and (rate := _number(match["rate"]))}
    if len(lines) > 1 and _SECTION.fullmatch(lines[0]) and (bare := _BARE.fullmatch(lines[1])):
        found.add(_number(bare["rate"]))
    rate = found.pop() if len(found) == 1 else 0.0
    return rate if 0.0 < rate <= FASTEST else None


def _number(text: str) -> float:
    return number(text.replace(",", "."), ".") or 0.0
