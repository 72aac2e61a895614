"""A lab's own list of its runs among the recordings: which mass each trial's target had."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath

import numpy as np

from spacerobot.recordings.drafting.files import MOST_FILES, Found
from spacerobot.recordings.drafting.groups import Trial, groups_of, trials_of
from spacerobot.recordings.drafting.masses import is_mass
from spacerobot.recordings.drafting.names import same, without_ending
from spacerobot.recordings.guess import guess
from spacerobot.recordings.readers.numbers import number
from spacerobot.recordings.readers.text import read_lines
from spacerobot.recordings.units import UNITS
from spacerobot.support.errors import InputError

LONGEST = 100_000
"""Bytes of a list that somebody keeps by hand."""

HEAD = 2000
"""Bytes in which its columns are named."""

_SEPARATORS = ("\t", ";", ",")

_RANGE = re.compile(r"[^\W\d]*[ _]?(\d{1,5})\s*(?:-|–|:|\.{2,3}|…|to|bis|through)\s*[^\W\d]*[ _]?(\d{1,5})")
"""From one run to another."""
_AND = re.compile(r"\s*[,;+&/]\s*|\s+(?:and|und)\s+|\s+")
_RUN = re.compile(r"[^\W\d]*_?\d{1,5}")


@dataclass(frozen=True)
class RunList:
    """A table with a row for each run.

    Attributes:
        file: relative to the folder, with the sheet of a workbook of several.
        rows: cells of each row by column.
        mass: the column with the target's mass.
        factor: kg per one of its unit.
        decimal: mark of its numbers.
    """

    file: str
    rows: tuple[Mapping[str, str], ...]
    mass: str
    factor: float
    decimal: str

    def masses(self, trials: Sequence[Trial]) -> dict[str, float]:
        """Trial -> its target's mass [kg], by the column that names most trials: by file, or by number.

        Empty where no column names half of them, or one of them twice with two masses.
        """
        best: dict[str, float] = {}
        called = _called(trials)
        for column in self.rows[0]:
            if column == self.mass:
                continue
            found: dict[str, set[float]] = {}
            for row in self.rows:
                if (mass := self._mass(row)) > 0.0:
                    for name in _meant(row[column], called):
                        found.setdefault(name, set()).add(mass)
            told = {name: own.pop() for name, own in found.items() if len(own) == 1}
            best = told if len(told) > len(best) else best
        return best if 2 * len(best) > len(trials) else {}

    def _mass(self, row: Mapping[str, str]) -> float:
        value = number(row[self.mass], self.decimal)
        return self.factor * value if value is not None and value > 0.0 else 0.0


def list_of_runs(folder: Path, files: Sequence[Found]) -> RunList | None:
    """The lab's own list of the trials that the other files make."""
    for runs in [*_run_lists(folder), *(sheet for f in files if (sheet := _sheet_list(f)) is not None)]:
        others = [f for f in files if f.label != runs.file]
        if others and runs.masses(trials_of(groups_of(others))):
            return runs
    return None


def _run_lists(folder: Path) -> list[RunList]:
    """The tables in a folder that have a column of masses of a target."""
    found = []
    for path in sorted(p for p in folder.rglob("*") if p.suffix.lower() in (".csv", ".tsv", ".txt")):
        if path.is_symlink() or not path.is_file() or not 0 < path.stat().st_size < LONGEST:
            continue
        with path.open("rb") as file:
            head = file.read(HEAD)
        if len(head) == HEAD and not _heading(head):
            continue
        try:
            lines = [line for line in read_lines(path) if line.strip() and not line.startswith("#")]
        except InputError:
            continue
        if (made := _list(str(path.relative_to(folder)), lines)) is not None:
            found.append(made)
    return found


def _sheet_list(file: Found) -> RunList | None:
    """A workbook's sheet as a list of runs; those are found by number, for a sheet's text is not read."""
    if file.format != "xlsx":
        return None
    head = file.table.names()
    rows = [[f"{v:g}" for v in row] for row in np.transpose([c.values for c in file.table.columns])]
    return _made(file.label, head, rows, comma=False)


def _heading(head: bytes) -> bool:
    """Whether some cell of the first lines speaks of a mass, so that the rest is worth reading."""
    text = re.split(r"[\t;,\r\n]", head.decode("utf-8", "replace"))
    return any(is_mass(cell) for cell in text if not any(c.isdigit() for c in cell))


def _list(file: str, lines: Sequence[str]) -> RunList | None:
    if len(lines) < 2:
        return None
    separator = max(_SEPARATORS, key=lines[0].count)
    head, *rest = csv.reader(lines, delimiter=separator, skipinitialspace=True)
    return _made(file, head, rest, comma=separator != ",")


def _made(file: str, head: Sequence[str], rest: Iterable[Sequence[str]], *, comma: bool) -> RunList | None:
    """The list of these rows; with `comma`, that may be the decimal mark of its numbers."""
    masses = [c for c in head if is_mass(c)]
    rows = tuple(dict(zip(head, (c.strip() for c in row), strict=True)) for row in rest if len(row) == len(head))
    if len(masses) != 1 or len(set(head)) < len(head) or len(head) < 2 or not rows:
        return None
    stated = guess(masses[0]).stated
    factor = UNITS[stated].factor if stated and UNITS[stated].dimension == "mass" else 1.0
    decimal = "," if comma and any("," in row[masses[0]] for row in rows) else "."
    return RunList(file, rows, masses[0], factor, decimal)


def _called(trials: Sequence[Trial]) -> dict[tuple[str, str], set[str]]:
    """What a cell may say, ("name", of a file with or without folder and ending) or ("number", its) -> trials."""
    found: dict[tuple[str, str], set[str]] = {}
    for trial in trials:
        names = {n for f in trial.files.values() for n in (f.relative, PurePath(f.relative).name)}
        names |= {without_ending(n) for n in names} | {part for n in names for part in PurePath(n).parts[:-1]}
        for key in [*(("name", n) for n in names), ("number", same(trial.id))]:
            found.setdefault(key, set()).add(trial.id)
    return found


def _meant(cell: str, called: Mapping[tuple[str, str], set[str]]) -> set[str]:
    """The trials that a cell names: by a file, by their number, or several at once."""
    if not cell:
        return set()
    keys = [("name", cell), ("number", same(cell)), *(("number", n) for n in _several(cell))]
    return set().union(*(called.get(key, ()) for key in keys))


def _several(cell: str) -> set[str]:
    """The numbers that a cell gives for several runs: "1-4", "run5 to run8", "1, 3 and 7"; none of one."""
    if between := _RANGE.fullmatch(cell):
        first, last = int(between[1]), int(between[2])
        return {str(n) for n in range(first, last + 1)} if last - first < MOST_FILES else set()
    parts = [p for p in _AND.split(cell) if p]
    return set(map(same, parts)) if len(parts) > 1 and all(_RUN.fullmatch(p) for p in parts) else set()
