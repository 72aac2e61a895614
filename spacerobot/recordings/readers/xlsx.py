"""Excel workbooks (.xlsx) through openpyxl: the stated sheet, else the first; values as last calculated."""

from __future__ import annotations

from datetime import UTC, datetime, time
from itertools import islice
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.base import Reader
from spacerobot.recordings.readers.layout import headings
from spacerobot.recordings.readers.numbers import number
from spacerobot.recordings.readers.sandbox import sandboxed_arrays
from spacerobot.recordings.table import Column, Floats, Options, RawTable
from spacerobot.support.errors import InputError

_HEAD = 200
"""Rows that may stand above a table."""

_SAMPLE = 25

_ABOVE = "above"
"""In place of an index: a number that stands above the table."""


class XlsxReader(Reader):
    """A sheet's columns, named by the rows above its table; `variable` names the sheet."""

    name: ClassVar[str] = "xlsx"
    suffixes: ClassVar[tuple[str, ...]] = (".xlsx", ".xlsm")

    def claims(self, path: Path, head: bytes) -> bool:
        """A zip archive with the right name."""
        return path.suffix.lower() in self.suffixes and head.startswith(b"PK")

    def parts(self, path: Path) -> tuple[str, ...]:
        """The sheets."""
        return sandboxed_arrays(path, "xlsx:parts")[1]

    def read(self, path: Path, options: Options) -> RawTable:
        """The sheet's columns; parsed in a child process."""
        arrays, notes = sandboxed_arrays(path, self.name, options.variable)
        first, last = options.rows or (0, None)
        columns: list[Column] = []
        above: list[tuple[str, float]] = []
        for label, values in arrays.items():
            index, stated, called = label.split(":", 2)
            if index == _ABOVE:
                above.append((called, float(values[0])))
                continue
            columns.append(Column((called or index,), np.ascontiguousarray(values[first:last]), stated or None))
        if not columns or not len(columns[0].values):
            raise InputError("the sheet has no rows of numbers", where=str(path))
        return RawTable(path, tuple(columns), None, notes, tuple(above))


def sheets(path: Path) -> list[str]:
    """The workbook's sheets of cells. Runs in the child process."""
    from openpyxl import load_workbook

    return [s.title for s in load_workbook(path, read_only=True, data_only=True, keep_links=False).worksheets]


def xlsx_arrays(path: Path, sheet: str | None) -> tuple[dict[str, Floats], list[str]]:
    """`INDEX:UNIT:NAME` -> column of a sheet, `above::NAME` -> a number above them, and remarks.

    Runs in the child process.

    Raises:
        InputError: no such sheet, no numbers in it, or more than the limit.
        whatever openpyxl raises on a broken file.
    """
    from openpyxl import load_workbook

    book = load_workbook(path, read_only=True, data_only=True, keep_links=False)
    names = [s.title for s in book.worksheets]
    if sheet is not None and sheet not in names:
        raise InputError(f"the workbook has no sheet {sheet!r}; it has {', '.join(names[:24])}")
    chosen = sheet or names[0]
    rows: list[list[float | None]] = []
    written: list[list[str]] = []
    cells = 0
    for row in book[chosen].iter_rows(values_only=True, max_col=limits.TEXT_COLUMNS):
        values = [_number(cell) for cell in row]
        cells += len(values)
        if cells > limits.ARRAY_VALUES:
            raise InputError("the sheet holds too many cells", valid=f"at most {limits.ARRAY_VALUES}")
        if len(written) < _HEAD:
            written.append(["" if cell is None else str(cell)[:100].strip() for cell in row])
        rows.append(values)
    first = _first(rows)
    if first is None:
        raise InputError("the sheet has no rows of numbers", given=chosen)
    width = max(len(r) for r in rows)
    lines = [[*cells, *[""] * width][:width] for cells in written[:first] if any(cells)]
    names_of, units = headings(lines, width)
    rows = rows[first:]
    table = np.full((len(rows), width), np.nan)
    for k, values in enumerate(rows):
        table[k, : len(values)] = [np.nan if v is None else v for v in values]
    called = [found[0] if found else "" for found in names_of]
    kept = [j for j in range(width) if called[j] or np.isfinite(table[:, j]).any()]
    notes = [f"the first of {len(names)} sheets, {chosen!r}, is read"] if sheet is None and len(names) > 1 else []
    return {
        f"{j}:{units[j] or ''}:{called[j]}": np.ascontiguousarray(table[:, j])
        for j in islice(kept, limits.TEXT_COLUMNS)
    } | _above(written[:first]), notes


def _above(lines: list[list[str]]) -> dict[str, Floats]:
    """`above::NAME` -> the number in lines of a name and a number, and perhaps a unit."""
    found: dict[str, Floats] = {}
    for line in lines:
        name, *rest = [cell for cell in line if cell] or [""]
        if len(rest) == 1:  # "5.5 kg" in one cell
            rest = rest[0].split(maxsplit=1)
        value = number(rest[0]) if rest and len(rest) < 3 else None
        if value is not None and number(name) is None:
            found[f"{_ABOVE}::{name}{f' [{rest[1]}]' if rest[1:] else ''}"] = np.array([value])
    return found


def _first(rows: list[list[float | None]]) -> int | None:
    """The first row of the table: of those with numbers in most columns that have them in the sheet's middle.

    What stands above it, a title, who did it and with what mass, has a number here and there.
    """
    filled = [r for r in rows if any(v is not None for v in r)]
    if not filled:
        return None
    middle = filled[len(filled) // 2 :][:_SAMPLE]
    width = max(map(len, middle))
    usual = [j for j in range(width) if sum(len(r) > j and r[j] is not None for r in middle) > 0.5 * len(middle)]
    enough = max(1, (len(usual) + 1) // 2)
    return next(i for i, r in enumerate(rows) if sum(len(r) > j and r[j] is not None for j in usual) >= enough)


def _number(cell: Any) -> float | None:
    """A cell's number; a date's seconds since 1970, a time's since midnight; None for anything else."""
    if isinstance(cell, datetime):
        return cell.replace(tzinfo=cell.tzinfo or UTC).timestamp()
    if isinstance(cell, time):
        return 3600.0 * cell.hour + 60.0 * cell.minute + cell.second + 1e-6 * cell.microsecond
    if isinstance(cell, bool) or cell is None:
        return None
    if isinstance(cell, int | float):
        return float(cell)
    value = number(cell) if isinstance(cell, str) else None
    return value if value is not None and np.isfinite(value) else None
