"""A lab's own list of its columns, for files that do not name them: columns.csv, or numbered lines of a README."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.readers.text import read_lines
from spacerobot.support.errors import InputError

LONGEST = 100_000
"""Bytes of a list that somebody keeps by hand."""

FEWEST = 3
"""Columns of a list: a file of fewer needs none, and any two numbered lines look like one."""

_NUMBERED = re.compile(
    r"[\s|*\-]*(?:col(?:umn)?\.?\s*)?(\d{1,3})\s*(?:[:.)|,;=\t]|\s-\s|\s)\s*[|\"']?\s*([^\W\d].*?)[\s|\"']*"
)
"""A line that gives a number a name: "0,Univ_Time", "| 3 | x [mm] |", "2) target position [mm]"."""

_SOME = re.compile(r"columns?\b", re.I)
"""What a list that names only some columns is called; any lines with numbers may look like one."""

_IN_ARRAY = re.compile(r"(.+)\[(\d+)\]")


@dataclass(frozen=True)
class ColumnList:
    """Names of columns, in order.

    Attributes:
        file: that says them, relative to the folder.
        names: one for each column, "" for those that it leaves out.
        whole: whether it names all; else it may be of any file that has as many.
    """

    file: str
    names: tuple[str, ...]
    whole: bool = True


def column_lists(folder: Path) -> list[ColumnList]:
    """The lists of columns in a folder: lines numbered from 0 or 1 without a gap."""
    found = []
    for path in sorted(p for p in folder.rglob("*") if p.suffix.lower() in (".csv", ".tsv", ".txt", ".md", "")):
        if path.is_symlink() or not path.is_file() or not 0 < path.stat().st_size < LONGEST:
            continue
        try:
            lines = read_lines(path)
        except InputError:
            continue
        file = str(path.relative_to(folder))
        runs = [ColumnList(file, names) for names in _runs(lines)]
        some = _some(lines) if not runs and _SOME.match(path.name) else ()
        found += [ColumnList(file, some, whole=False)] if some else runs
    return found


def _some(lines: Sequence[str]) -> tuple[str, ...]:
    """The names of lines that are numbered from 0 with gaps; none where a line is not, but for the first."""
    said = [_NUMBERED.fullmatch(line) for line in lines if line.strip()]
    named = {int(match[1]): match[2] for match in said if match}
    if not named or None in said[1:] or len(set(named.values())) < len(named):
        return ()
    return tuple(named.get(n, "") for n in range(max(named) + 1))


def _runs(lines: Sequence[str]) -> list[tuple[str, ...]]:
    """The names of each run of lines that are numbered one after the other."""
    runs: list[list[str]] = []
    last = -2
    for line in lines:
        if (match := _NUMBERED.fullmatch(line)) is None:
            last = last if not line.strip() else -2
            continue
        number, name = int(match[1]), match[2]
        if number == last + 1:
            runs[-1].append(name)
        elif number in (0, 1):
            runs.append([name])
        else:
            number = -2
        last = number
    return [tuple(run) for run in runs if len(run) >= FEWEST and len(set(run)) == len(run)]


def with_lists(files: Sequence[Found], lists: Sequence[ColumnList]) -> list[Found]:
    """The files but for the lists; columns without names carry those of the one list that is as long, or of some."""
    named = [_labelled(file, lists) for file in files]
    used = {file.labelled_by for file in named} | {names.file for names in lists if not names.whole}
    return [file for file in named if file.relative not in used]


def _labelled(file: Found, lists: Sequence[ColumnList]) -> Found:
    columns = file.table.columns
    if not any(c.names for c in columns):
        places = {"": list(range(len(columns)))}
    else:
        places = {}
        for j, column in enumerate(columns):
            if column.names and (inside := _IN_ARRAY.fullmatch(column.names[0])):
                places.setdefault(inside[1], []).append(j)
    for own in places.values():
        whole = {names.names: names for names in lists if names.whole and len(names.names) == len(own)}
        fitting = whole or {names.names: names for names in lists if not names.whole and len(names.names) <= len(own)}
        if len(fitting) == 1:
            said = next(iter(fitting.values()))
            labels = dict(zip(own, said.names, strict=False))
            return replace(file, labels=tuple(labels.get(j, "") for j in range(len(columns))), labelled_by=said.file)
    return file
