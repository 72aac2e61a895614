"""The files of a folder that may be recordings, each read as far as it can be."""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from pathlib import Path, PurePath

import numpy as np

from spacerobot.recordings.cleaning import ENOUGH
from spacerobot.recordings.drafting.masses import above_table, scalars, with_masses
from spacerobot.recordings.drafting.names import ENDINGS, Named, named, without_ending
from spacerobot.recordings.drafting.stated_rate import stated_rate
from spacerobot.recordings.guess import find_time
from spacerobot.recordings.readers import read_table, reader_for
from spacerobot.recordings.readers.garbage import written_to
from spacerobot.recordings.table import Floats, Options, RawTable
from spacerobot.support.errors import InputError

MOST_FILES = 2000

MOST_PARTS = 100
"""Sheets or topics of one file that are read."""

FAR = 5.0
"""How many spans, and sizes, of all other readings away what stands for none is: no sensor jumps so, and back."""

SHORTEST = 3
"""Rows of a recording: a rate and its change need so many."""

_NO_RECORDING = re.compile(r"(readme|licen[cs]e|makefile|changelog|notice|authors|copying)", re.I)


@dataclass(frozen=True)
class Found:
    """A file that holds columns of numbers.

    Attributes:
        relative: path relative to the folder.
        format: name of its reader.
        table: its columns, NaN where a cell is no number.
        usable: indices of the columns that hold numbers a sensor may have given.
        named: what its name says.
        missing: readings that stand for none: the same again and again, far from all others.
        lost: columns that read exactly 0 where a tracker had lost what it follows.
        fault: what is wrong with some cell of a usable column, None where nothing is.
        variable: the one array, sheet or topic of a file of several that this is, None for a file that is one.
        rate: readings a second of a file or array without a clock of its own [Hz], None where nothing says it.
        times: the file that holds its times alone, their column and these [s]; None where it has none.
        labels: what a list beside the file calls its columns, "" where it says nothing of one; none without a list.
        labelled_by: that list.
        span: first and one past the last of the table's rows that this is, None for all.
    """

    relative: str
    format: str
    table: RawTable
    usable: tuple[int, ...]
    named: Named
    missing: tuple[float, ...] = ()
    fault: str | None = None
    variable: str | None = None
    rate: float | None = None
    times: tuple[str, str, Floats] | None = None
    labels: tuple[str, ...] = ()
    labelled_by: str = ""
    lost: frozenset[int] = frozenset()
    span: tuple[int, int] | None = None

    @property
    def label(self) -> str:
        """The file, and which part of it."""
        return self.relative if self.variable is None else f"{self.relative}, {self.variable}"

    @functools.cached_property
    def clock(self) -> int | None:
        """Index of the column that is its clock."""
        return find_time(self.called) if self.times is None else None

    @property
    def called(self) -> RawTable:
        """The table with the names that a list beside the file gives its columns."""
        if not self.labels:
            return self.table
        pairs = zip(self.labels, self.table.columns, strict=True)
        return replace(self.table, columns=tuple(replace(c, names=(label,)) if label else c for label, c in pairs))

    @property
    def rows(self) -> int:
        """Rows of its longest column."""
        return max((len(c.values) for c in self.table.columns), default=0)

    def columns(self) -> tuple[str, ...]:
        """Names that tell one kind of file from another: one for each column that has a name."""
        return tuple(c.names[0] if c.names else "" for c in self.table.columns)


def recordings_in(folder: Path, pattern: str = "*") -> tuple[list[Found], list[str]]:
    """The recordings beneath `folder`, and remarks on files that cannot be read.

    Args:
        folder: that holds them.
        pattern: of their names, or of their paths relative to the folder.

    Raises:
        InputError: no such folder, none of such a name in it, or too many.
    """
    if not folder.is_dir():
        raise InputError("no such folder", given=str(folder))
    files = sorted(p for p in folder.rglob("*") if _considered(p, folder))
    every = files
    files = [p for p in files if fnmatch(p.name, pattern) or fnmatch(str(p.relative_to(folder)), pattern)]
    if every and not files:
        names = ", ".join(str(p.relative_to(folder)) for p in every[:12])
        raise InputError("no file of the folder has such a name", given=pattern, valid=names)
    if len(files) > MOST_FILES:
        raise InputError("the folder holds too many files", given=len(files), valid=f"at most {MOST_FILES}")
    found: list[Found] = []
    refused: list[str] = []
    for path in files:
        relative = path.relative_to(folder)
        try:
            parts = reader_for(path).parts(path)
        except InputError as error:
            refused.append(str(error).replace(str(path), str(relative)))
            continue
        for part in parts[:MOST_PARTS] if len(parts) > 1 else (None,):
            try:
                found.append(_read(path, relative, part))
            except InputError as error:
                inside = f" ({part})" if part else ""
                refused.append(str(error).replace(str(path), f"{relative}{inside}"))
    return found, refused


def robots_in(folder: Path) -> list[Path]:
    """The URDFs in the folder itself, relative to it."""
    files = (p for p in sorted(folder.glob("*.urdf")) if p.is_file() and not p.is_symlink())
    return [p.relative_to(folder) for p in files if _writable(p)]


def _read(path: Path, relative: PurePath, part: str | None) -> Found:
    table = read_table(path, Options(variable=part, wanted=frozenset()))
    usable = tuple(j for j, column in enumerate(table.columns) if _has_readings(column.values) and written_to(column))
    if not usable:
        raise InputError("no columns of numbers", where=str(path))
    if max(len(table.columns[j].values) for j in usable) < SHORTEST:
        raise InputError("too short for a recording", valid=f"at least {SHORTEST} rows", where=str(path))
    fault = None
    try:
        read_table(path, Options(variable=part, wanted=frozenset(map(str, usable))))
    except InputError as error:
        fault = str(error).replace(str(path), str(relative))
    stands_for_none = {j: value for j in usable if (value := sentinel(table.columns[j].values)) is not None}
    lost = frozenset(j for j in usable if j not in stands_for_none and is_lost_at_zero(table.columns[j].values))
    columns = list(table.columns)
    for j, value in [*stands_for_none.items(), *((j, 0.0) for j in lost)]:
        columns[j] = replace(columns[j], values=np.where(columns[j].values == value, np.nan, columns[j].values))
    missing = tuple(sorted(set(stands_for_none.values())))
    table = replace(table, columns=tuple(columns))
    form = reader_for(path).name
    masses = scalars(table) + (above_table(path) if form in ("csv", "text") else [])
    name = relative if part is None else relative.with_name(f"{without_ending(relative.name)}_{part.replace('/', '_')}")
    said = with_masses(named(name), masses)
    rate = stated_rate(path) if form in ("csv", "text") else None
    return Found(str(relative), form, table, usable, said, missing, fault, variable=part, rate=rate, lost=lost)


def _has_readings(values: Floats) -> bool:
    """Whether numbers stand in a fifth of the rows, or in as many as a slow sensor in a fast log has."""
    seen = np.isfinite(values)
    return bool(seen.sum() > 2 and (seen.mean() > 0.2 or seen.sum() >= ENOUGH))


def sentinel(values: Floats) -> float | None:
    """The reading that stands for none, such as -9999: given more than once, and FAR beyond the span of all others."""
    seen = values[np.isfinite(values)]
    for value in (seen.min(), seen.max()) if len(seen) else ():
        others = seen[seen != value]
        if len(seen) - len(others) < 2 or len(others) < 2:
            continue
        low, high = others.min(), others.max()
        if max(low - value, value - high) > FAR * max(high - low, abs(low), abs(high)) > 0.0:
            return float(value)
    return None


def is_lost_at_zero(values: Floats) -> bool:
    """Whether a column jumps to or from exactly 0 where all else that it reads is on one side, and far from it.

    A tracker's position does where it has lost its body, or has not begun: further than FAR times its largest step. A
    force that rests at 0 comes back to it, or passes it.
    """
    zero = values == 0.0
    steps = np.abs(np.diff(values))
    jumps, inside = steps[zero[1:] != zero[:-1]], steps[~zero[1:] & ~zero[:-1]]
    inside = inside[np.isfinite(inside)]
    if zero.sum() < 2 or len(inside) < 2 or not len(jumps) or not np.isfinite(jumps).all():
        return False
    nearest = float(np.nanmin(np.abs(values[~zero])))
    aside = np.nanmin(values[~zero]) > 0.0 or np.nanmax(values[~zero]) < 0.0
    return bool(aside and min(nearest, jumps.min()) > FAR * inside.max() > 0.0)


def _considered(path: Path, folder: Path) -> bool:
    if any(part.startswith(".") for part in path.relative_to(folder).parts) or path.is_symlink():
        return False
    if not path.is_file() or not _writable(path) or _NO_RECORDING.match(path.name):
        return False
    ending = path.suffix.lower()
    return ending in ENDINGS or not re.fullmatch(r"\.[a-z][a-z0-9]*", ending)


def _writable(path: Path) -> bool:
    """Whether a study, which is UTF-8, can name the file."""
    try:
        str(path).encode("utf-8")
    except UnicodeEncodeError:
        return False
    return True
