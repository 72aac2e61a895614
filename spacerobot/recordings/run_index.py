"""A lab's own list of its runs, one a row: `[[trials]] index = "runs.csv"` makes a trial of each.

`{COLUMN}` in a trial's texts is replaced by the row's cell. Where a number is asked for, a cell alone is it, with its
unit behind it if need be: `target.mass = "{mass} g"`. What an empty cell was to say is left out.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spacerobot.recordings.readers.text import read_lines
from spacerobot.recordings.units import UNITS, factor
from spacerobot.recordings.values import kind
from spacerobot.support.errors import InputError, NotFoundError

_CELL = re.compile(r"\{([^{}]+)\}")
_NUMBER = re.compile(r"\{([^{}]+)\}\s*(\S.*)?")
_POINTED = re.compile(r"[-+]?\d*\.\d+(e[-+]?\d+)?", re.IGNORECASE)
_SEPARATORS = ("\t", ";", ",")


@dataclass(frozen=True)
class Row:
    """One run of an index file.

    Attributes:
        cells: column -> text, stripped.
        where: file and line.
        decimal: what separates whole and fraction.
    """

    cells: Mapping[str, str]
    where: str
    decimal: str

    def fill(self, value: Any, texts: bool, name: str = "") -> Any:
        """`value` with its cells in place; None where one that it is made of is empty.

        Args:
            value: of a trial's key, tables and lists of them too.
            texts: whether it is a text (a file's name), else cells alone are numbers.
            name: dotted, of the value.

        Raises:
            InputError: a cell that is no number where one is asked for; a column that is not there; a unit that cannot
                measure this value.
        """
        if isinstance(value, dict):
            inside = {k: self.fill(v, texts, f"{name}.{k}") for k, v in value.items()}
            kept = {k: v for k, v in inside.items() if v is not None}
            return kept if kept or not inside else None
        if isinstance(value, list):
            items = [self.fill(v, texts, name) for v in value]
            return None if None in items else items
        if not isinstance(value, str) or not _CELL.search(value):
            return value
        found = {name: self._cell(name) for name in _CELL.findall(value)}
        if not all(found.values()):
            return None
        alone = None if texts else _NUMBER.fullmatch(value)
        if alone:
            number = self._number(found[alone[1]], alone[1])
            return number * self._factor(alone[2], name) if alone[2] else number
        return _CELL.sub(lambda m: found[m[1]], value)

    def _cell(self, name: str) -> str:
        if name not in self.cells:
            raise NotFoundError("column of the index", name, self.cells, where=self.where)
        return self.cells[name]

    def _factor(self, written: str, name: str) -> float:
        """SI units of a value per one of what is written behind its cell."""
        si = kind(name, where=self.where).unit
        if si not in UNITS:
            raise InputError(f"{name} is stated in {si}", given=written, valid="the cell alone", where=self.where)
        return factor(written, (UNITS[si].dimension,), where=self.where)

    def _number(self, text: str, column: str) -> float:
        try:
            return float(text.replace(self.decimal, ".") if self.decimal != "." else text)
        except ValueError:
            raise InputError(f"column {column!r} must hold a number", given=text, where=self.where) from None


def read_index(path: Path) -> tuple[Row, ...]:
    """The rows of a table with a header: separated by tabs, semicolons or commas; `#` begins a comment line.

    Raises:
        InputError: no rows, a column named twice or not at all, a row of another width; with file and line.
    """
    lines = [(n, text) for n, text in enumerate(read_lines(path), 1) if text.strip() and not text.startswith("#")]
    if len(lines) < 2:
        raise InputError("an index needs a header and a row for each run", where=str(path))
    separator = max(_SEPARATORS, key=lines[0][1].count)
    rows = list(_split(lines, separator, path))
    names = rows[0][1]
    if "" in names or len(set(names)) < len(names):
        raise InputError("each column of an index needs a name of its own", given=names, where=f"{path}:{rows[0][0]}")
    for line, cells in rows[1:]:
        if len(cells) != len(names):
            valid = f"{len(names)}, as the header"
            raise InputError("a row of another width", given=f"{len(cells)} cells", valid=valid, where=f"{path}:{line}")
    pointed = any(_POINTED.fullmatch(cell) for _, cells in rows[1:] for cell in cells)
    decimal = "." if separator == "," or pointed else ","
    return tuple(Row(dict(zip(names, cells, strict=True)), f"{path}:{line}", decimal) for line, cells in rows[1:])


def _split(lines: Sequence[tuple[int, str]], separator: str, path: Path) -> Iterator[tuple[int, list[str]]]:
    try:
        for number, text in lines:
            (cells,) = csv.reader([text], delimiter=separator, strict=True)
            yield number, [c.strip() for c in cells]
    except (csv.Error, ValueError):
        raise InputError("a row that cannot be read", given=text[:80], where=f"{path}:{number}") from None
