"""The mass of a trial's target, where the file itself states it: in a number of its own, or above its table."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from spacerobot.recordings.drafting.languages import words_in
from spacerobot.recordings.drafting.names import Named
from spacerobot.recordings.drafting.vocabulary import THINGS
from spacerobot.recordings.guess import guess
from spacerobot.recordings.readers.numbers import number
from spacerobot.recordings.readers.text import read_lines
from spacerobot.recordings.table import Floats, RawTable
from spacerobot.recordings.units import UNITS
from spacerobot.support.errors import InputError

HEAD = 60
"""Lines of a file that may stand above its table."""

_STATED = re.compile(
    r"\W*(?P<name>[^:=;,\t]*[^\W\d][^:=;,\t]*?)\s*[:=;,\t]\s*(?P<value>\d+(?:[.,]\d+)?)\s*(?P<unit>\w*)\W*"
)
"""A line that gives one number a name: "Target mass [kg]; 12,5"."""

_REMARKED = re.compile(r"(?<![\w.,])(\d+(?:[.,]\d+)?)\s*kg(?![\w/*])")

_OTHERS = frozenset({"arm", *THINGS["wrist"], *THINGS["hand"], *THINGS["base"]})
"""Things whose mass is no target's."""

Stated = tuple[str, float, str]
"""Name, number and unit of mass."""


def is_mass(name: str) -> bool:
    """Whether a name is that of a target's mass: "target mass", "m_target", not "slider mass"."""
    words = words_in(name)
    symbol = "m" in words and bool(THINGS["target"].intersection(words[words.index("m") :]))  # before: metres
    return not _OTHERS.intersection(words) and ("mass" in words or symbol)


def scalars(table: RawTable) -> list[Stated]:
    """Masses among a file's single numbers, and in columns that say one number throughout."""
    single = [*table.stated]
    single += [(c.names[0], float(c.values[0])) for c in table.columns if c.names and _is_one_number(c.values)]
    return [stated for name, value in single for stated in _stated(name, value, "")]


def _is_one_number(values: Floats) -> bool:
    return len(values) > 0 and bool((values == values[0]).all())


def above_table(path: Path) -> list[Stated]:
    """Masses in the lines above a text file's table."""
    try:
        lines = read_lines(path)[:HEAD]
    except InputError:
        return []
    found = [match for line in lines if (match := _STATED.fullmatch(line))]
    stated = [s for m in found for s in _stated(m["name"], number(m["value"].replace(",", "."), "."), m["unit"])]
    return stated or [s for line in lines if (s := _in_a_remark(line)) is not None]


def _in_a_remark(line: str) -> Stated | None:
    """The one mass that a sentence states, of nothing else than a target: "hit with 12.5 kg"."""
    found = _REMARKED.findall(line)
    if len(found) != 1 or _OTHERS.intersection(words_in(line)):
        return None
    return f"{found[0]} kg", float(found[0].replace(",", ".")), "kg"


def with_masses(named: Named, masses: list[Stated]) -> Named:
    """What a name says, and what the file states beside."""
    return replace(named, values=(*named.values, *masses))


def _stated(name: str, value: float | None, unit: str) -> Iterator[Stated]:
    said = unit or guess(name.strip()).stated or "kg"
    if is_mass(name) and value is not None and value > 0.0 and said in UNITS and UNITS[said].dimension == "mass":
        yield name.strip(), value, said
