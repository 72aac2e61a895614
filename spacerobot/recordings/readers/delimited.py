"""Tables of text: CSV with any usual separator, and columns set apart by blanks."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.base import Reader
from spacerobot.recordings.readers.layout import Layout, column_heads, find_layout, split
from spacerobot.recordings.readers.numbers import number, reason
from spacerobot.recordings.readers.text import read_lines
from spacerobot.recordings.table import Column, Floats, Options, RawTable
from spacerobot.support.errors import InputError

_LIST = re.compile(r"[\[(]([^\[\]()]*)[\])]")

LONGEST_LIST = 64
"""Most columns that a list in a cell becomes."""


class DelimitedReader(Reader):
    """CSV: separator, decimal mark and header are found out unless the study states them."""

    name: ClassVar[str] = "csv"
    suffixes: ClassVar[tuple[str, ...]] = (".csv", ".tsv")

    def claims(self, path: Path, head: bytes) -> bool:
        """Any text may be a table; zero bytes without a byte-order mark are no text."""
        return not path.is_dir()

    def read(self, path: Path, options: Options) -> RawTable:
        """The columns, with the names that the header gives them."""
        lines = read_lines(path, options.compression, options.encoding)
        try:
            layout = find_layout(lines, options.separator, options.decimal, options.header_rows)
        except InputError as error:
            raise InputError(error.what, valid=error.valid, where=str(path)) from None
        names, units = column_heads(lines, layout)
        rows = layout.rows
        if options.rows is not None:
            rows = rows[options.rows[0] : options.rows[1]]
        if not rows:
            line = layout.rows[0] if layout.rows else len(lines) - 1
            raise InputError("the file has no rows of numbers", where=f"{path}:{max(line, 0) + 1}")
        if options.rows is not None:  # the chosen rows may be laid out unlike the rest of the file
            width = len(split(lines[rows[0]], layout.separator))
            names = names if width == layout.width else [()] * width
        else:
            width = layout.width
        limits.check_cells(path, len(rows), width)
        values = numbers_of(path, lines, rows, layout, width, _wanted(names, options))
        if options.reshape is None:
            values, names = _with_lists(lines, rows, layout, values, names)
        values, names, numbers = _trim_and_reshape(path, values, names, rows, options)
        units = units if len(names) >= len(units) and any(names) else []
        stated = [*units, *[None] * values.shape[1]]
        columns = tuple(Column(names[j], np.ascontiguousarray(values[:, j]), stated[j]) for j in range(values.shape[1]))
        return RawTable(path, columns, numbers)


class TextReader(DelimitedReader):
    """Columns set apart by blanks, as logs and instrument software write them."""

    name: ClassVar[str] = "text"
    suffixes: ClassVar[tuple[str, ...]] = (".txt", ".dat", ".log", ".asc")


def _wanted(names: Sequence[tuple[str, ...]], options: Options) -> set[int] | None:
    if options.wanted is None or (options.reshape or 1) > 1:
        return None
    return {j for j, called in enumerate(names) if options.wanted & {*called, str(j)}}


def numbers_of(
    path: Path, lines: Sequence[str], rows: Sequence[int], layout: Layout, width: int, wanted: set[int] | None
) -> Floats:
    """The rows' numbers, (rows, width), NaN where a cell is empty.

    Args:
        path: the file, for what is wrong with it.
        lines: all its lines.
        rows: indices of those that are read.
        layout: how they are laid out.
        width: cells of each.
        wanted: columns that must hold numbers, None for all.

    Raises:
        InputError: a row of another width, or no number in a column that is wanted.
    """
    values = _fast(lines, rows, layout, width)
    return values if values is not None else _careful(path, lines, rows, layout, width, wanted)


def _fast(lines: Sequence[str], rows: Sequence[int], layout: Layout, width: int) -> Floats | None:
    """All cells at once where all are plain numbers, None where one needs a closer look."""
    from spacerobot.recordings.readers.decimals import decimals  # takes a moment to load

    if layout.decimal != ".":
        return None
    whole = rows[-1] - rows[0] + 1 == len(rows)
    chosen = lines[rows[0] : rows[-1] + 1] if whole else [lines[i] for i in rows]
    return decimals(chosen, layout.separator, width)


def _careful(
    path: Path, lines: Sequence[str], rows: Sequence[int], layout: Layout, width: int, wanted: set[int] | None
) -> Floats:
    """Cell by cell, refusing with the line whatever is not a number in a column that is wanted."""
    values = np.full((len(rows), width), np.nan)
    for row, index in enumerate(rows):
        cells = split(lines[index], layout.separator)
        if len(cells) != width and not (len(cells) == width + 1 and not cells[-1]):
            raise InputError(
                "the row is ragged",
                given=f"{len(cells)} cells",
                valid=f"{width} cells, as in most rows",
                where=f"{path}:{index + 1}",
            )
        for j, cell in enumerate(cells[:width]):
            value = number(cell, layout.decimal)
            if value is None:
                if wanted is None or j in wanted:
                    raise InputError(f"column {j}: {reason(cell)}", given=cell, where=f"{path}:{index + 1}")
                continue
            values[row, j] = value
    return values


def _with_lists(
    lines: Sequence[str], rows: Sequence[int], layout: Layout, values: Floats, names: list[tuple[str, ...]]
) -> tuple[Floats, list[tuple[str, ...]]]:
    """Further columns for cells that hold a list of numbers: NAME[0], NAME[1], ..., NaN where a list is shorter."""
    first = split(lines[rows[0]], layout.separator)
    listed = [j for j in range(min(len(first), len(names))) if names[j] and _LIST.fullmatch(first[j])]
    for j in listed:
        cells = []
        for index in rows:
            row = split(lines[index], layout.separator)
            found = _LIST.fullmatch(row[j]) if j < len(row) else None
            cells.append([number(c) for c in re.split(r"[\s,;]+", found.group(1).strip())] if found else [])
        width = len(cells[0])
        if not 0 < width <= LONGEST_LIST or any(len(c) > width or None in c for c in cells):
            continue
        more = np.full((len(rows), width), np.nan)
        for row_number, cell in enumerate(cells):
            more[row_number, : len(cell)] = cell
        values = np.hstack([values, more])
        names = [*names, *((f"{names[j][0]}[{k}]",) for k in range(width))]
    return values, names


def _trim_and_reshape(
    path: Path, values: Floats, names: list[tuple[str, ...]], rows: Sequence[int], options: Options
) -> tuple[Floats, list[tuple[str, ...]], np.ndarray]:
    """Drop a last column that only a trailing separator made; fold interleaved values into rows."""
    unbroken = rows[-1] - rows[0] + 1 == len(rows)
    numbers = (np.arange(rows[0], rows[-1] + 1) if unbroken else np.array(rows, dtype=np.int64)) + 1
    if values.shape[1] > 1 and not names[-1] and np.isnan(values[:, -1]).all():
        values, names = values[:, :-1], names[:-1]
    count = options.reshape or 1
    if count > 1:
        if values.shape[1] != 1:
            raise InputError(
                "only a file of one column can be reshaped",
                given=f"{values.shape[1]} columns",
                where=str(path),
            )
        whole, rest = divmod(len(values), count)
        if rest:
            raise InputError(
                f"the values do not come in groups of {count}",
                given=f"{len(values)} values",
                where=f"{path}:{int(numbers[-1])}",
            )
        values, names, numbers = values.reshape(whole, count), [()] * count, numbers[::count]
    return values, names, numbers
