"""What a reader hands over: named columns of raw numbers, and the line that each row came from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spacerobot.support.errors import InputError, NotFoundError

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Options:
    """What a study says about a file's layout; None leaves it to the reader to find out.

    Attributes:
        variable: array inside the file, or topic of a bag.
        separator: between cells.
        decimal: "." or ",".
        header_rows: lines before the data.
        rows: first and one past the last data row.
        reshape: number of interleaved values a row.
        compression: see stream.COMPRESSIONS.
        encoding: of text.
        wanted: columns that will be used; others may hold anything. None for all.
    """

    variable: str | None = None
    separator: str | None = None
    decimal: str | None = None
    header_rows: int | None = None
    rows: tuple[int, int | None] | None = None
    reshape: int | None = None
    compression: str | None = None
    encoding: str | None = None
    wanted: frozenset[str] | None = None


@dataclass(frozen=True)
class Column:
    """One column.

    Attributes:
        names: what the file calls it; several where the header has several lines.
        values: (rows,) raw numbers, NaN where the cell is empty.
        unit: unit that the file itself states, None where it says nothing.
    """

    names: tuple[str, ...]
    values: Floats
    unit: str | None = None


@dataclass(frozen=True)
class RawTable:
    """A file's columns, as read.

    Attributes:
        path: the file.
        columns: in the file's order; all of one length, except in files of separate arrays.
        lines: (rows,) line of each row in the file, None where rows have no lines.
        notes: remarks for the user.
        stated: single numbers that stand above the table, (name, value).
    """

    path: Path
    columns: tuple[Column, ...]
    lines: NDArray[np.int64] | None = None
    notes: tuple[str, ...] = ()
    stated: tuple[tuple[str, float], ...] = ()

    def names(self) -> tuple[str, ...]:
        """One name for each column: the first that is its own, else its index."""
        taken: dict[str, int] = {}
        for column in self.columns:
            for name in set(column.names):
                taken[name] = taken.get(name, 0) + 1
        return tuple(
            next((n for n in column.names if taken[n] == 1), str(index)) for index, column in enumerate(self.columns)
        )

    def index(self, name: str, *, where: str | None = None) -> int:
        """Index of the column called `name`, or numbered so.

        Raises:
            InputError: two columns have this name.
            NotFoundError: none has.
        """
        found = [i for i, column in enumerate(self.columns) if name in column.names]
        if len(found) == 1:
            return found[0]
        if found:
            raise InputError(
                f"{len(found)} columns have the same name in {self.path.name}",
                given=name,
                valid=f"choose by index: {', '.join(map(str, found))}",
                where=where or str(self.path),
            )
        if name.isascii() and name.isdigit() and len(name) < 7 and int(name) < len(self.columns):
            return int(name)
        raise NotFoundError(f"column of {self.path.name}", name, self.names(), where=where or str(self.path))

    def __getitem__(self, name: str) -> Floats:
        return self.columns[self.index(name)].values

    def at(self, row: int) -> str:
        """`file:line` of a row, or `file: row n` where there are no lines."""
        if self.lines is not None and 0 <= row < len(self.lines):
            return f"{self.path}:{int(self.lines[row])}"
        return f"{self.path}: row {row}"
