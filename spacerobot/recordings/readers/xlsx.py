"""Excel workbooks (.xlsx) through openpyxl: the stated sheet, else the first; values as last calculated."""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.base import Reader
from spacerobot.recordings.readers.numbers import number
from spacerobot.recordings.readers.sandbox import sandboxed_arrays
from spacerobot.recordings.table import Column, Floats, Options, RawTable
from spacerobot.support.errors import InputError


class XlsxReader(Reader):
    """A sheet's columns, named by the row above the first numbers; `variable` names the sheet."""

    name: ClassVar[str] = "xlsx"
    suffixes: ClassVar[tuple[str, ...]] = (".xlsx", ".xlsm")

    def claims(self, path: Path, head: bytes) -> bool:
        """A zip archive with the right name."""
        return path.suffix.lower() in self.suffixes and head.startswith(b"PK")

    def read(self, path: Path, options: Options) -> RawTable:
        """The sheet's columns; parsed in a child process."""
        arrays, notes = sandboxed_arrays(path, self.name, options.variable)
        first, last = options.rows or (0, None)
        columns = []
        for label, values in arrays.items():
            index, _, called = label.partition(":")
            columns.append(Column((called or index,), np.ascontiguousarray(values[first:last])))
        if not columns or not len(columns[0].values):
            raise InputError("the sheet has no rows of numbers", where=str(path))
        return RawTable(path, tuple(columns), None, notes)


def xlsx_arrays(path: Path, sheet: str | None) -> tuple[dict[str, Floats], list[str]]:
    """`INDEX:NAME` -> column of a sheet, and remarks. Runs in the child process.

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
    header: list[str] = []
    cells = 0
    for row in book[chosen].iter_rows(values_only=True, max_col=limits.TEXT_COLUMNS):
        values = [_number(cell) for cell in row]
        cells += len(values)
        if cells > limits.ARRAY_VALUES:
            raise InputError("the sheet holds too many cells", valid=f"at most {limits.ARRAY_VALUES}")
        if not rows and not any(v is not None for v in values):
            words = ["" if cell is None else str(cell)[:100].strip() for cell in row]
            header = words if sum(map(bool, words)) >= sum(map(bool, header)) else header
            continue
        rows.append(values)
    if not rows:
        raise InputError("the sheet has no rows of numbers", given=chosen)
    width = max(len(r) for r in rows)
    table = np.full((len(rows), width), np.nan)
    for k, values in enumerate(rows):
        table[k, : len(values)] = [np.nan if v is None else v for v in values]
    called = [*header, *[""] * width][:width]
    kept = [j for j in range(width) if called[j] or np.isfinite(table[:, j]).any()]
    notes = [f"the first of {len(names)} sheets, {chosen!r}, is read"] if sheet is None and len(names) > 1 else []
    return {f"{j}:{called[j]}": np.ascontiguousarray(table[:, j]) for j in islice(kept, limits.TEXT_COLUMNS)}, notes


def _number(cell: Any) -> float | None:
    """A cell's number; None for anything else (a date is no number of seconds that a study could mean)."""
    if isinstance(cell, bool) or cell is None:
        return None
    if isinstance(cell, int | float):
        return float(cell)
    value = number(cell) if isinstance(cell, str) else None
    return value if value is not None and np.isfinite(value) else None
