"""Finding out how a delimited text is laid out: separator, decimal mark, header, columns."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.numbers import number
from spacerobot.support.errors import InputError

COMMENTS = ("#", "%", "//")

_CANDIDATES = (
    (";", "."),
    (";", ","),
    ("\t", "."),
    ("\t", ","),
    (",", "."),
    ("|", "."),
    (" ", "."),
    (" ", ","),
)
_SAMPLE = 25
_WORD = re.compile(r"(?!nan|inf)[a-z]{2}", re.IGNORECASE)


@dataclass(frozen=True)
class Layout:
    """How a text table is laid out.

    Attributes:
        separator: between cells; " " stands for any run of blanks.
        decimal: "." or ",".
        header: indices of the lines before the data that are not blank.
        first: index of the first data line.
        width: cells of a data line.
        numeric: per column, whether its cells are numbers.
    """

    separator: str
    decimal: str
    header: tuple[int, ...]
    first: int
    width: int
    numeric: tuple[bool, ...]


def split(line: str, separator: str) -> list[str]:
    """The cells of a line, quotes understood, blanks around them removed."""
    if separator == " ":
        return [c.strip('"') for c in line.split()]
    if '"' in line:
        try:
            cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
        except csv.Error:
            cells = line.split(separator)
    else:
        cells = line.split(separator)
    return [c.strip() for c in cells]


def find_layout(lines: Sequence[str], separator: str | None, decimal: str | None, header_rows: int | None) -> Layout:
    """The layout under which a header names every column, then that under which most cells are numbers.

    Cells are those of the table's middle; of equals the layout with most columns of numbers.

    Raises:
        InputError: more columns than the limit.
    """
    start = header_rows or 0
    body = said(lines, start)
    if not body:
        return Layout(separator or ",", decimal or ".", (), len(lines), 0, ())
    half = len(body) // 2 if header_rows is None else 0
    sample = [lines[i] for i in body[half : half + _SAMPLE]]
    sample = [line for line in sample if not _WORD.search(line)] or sample
    best: tuple[tuple[bool, float, int], str, str, int, tuple[bool, ...]] | None = None
    for sep, mark in _CANDIDATES:
        if (separator is not None and sep != separator) or (decimal is not None and mark != decimal):
            continue
        rows = [split(line, sep) for line in sample]
        if max(map(len, rows)) > limits.TEXT_COLUMNS:
            raise InputError("too many columns", valid=f"at most {limits.TEXT_COLUMNS}")
        width, agreeing = Counter(map(len, rows)).most_common(1)[0]
        if width == 1 and mark == "," and decimal is None:
            continue  # "1,5" alone is two columns, unless the study says otherwise
        kept = [r for r in rows if len(r) == width]
        numeric = tuple(
            sum(number(r[j], mark) is not None for r in kept) >= 0.9 * len(kept)
            and any(_plain(r[j], mark) for r in kept)
            for j in range(width)
        )
        good = sum(numeric) / width * agreeing / len(rows)
        key = (_headed(lines, body[:half], sep, width, sum(numeric)), round(good, 2), sum(numeric))
        if best is None or key > best[0]:
            best = (key, sep, mark, width, numeric)
    if best is None:
        best = ((False, 0.0, 0), separator or ",", decimal or ".", len(split(sample[0], separator or ",")), ())
    _, sep, mark, width, numeric = best
    first = start if header_rows is not None else _first_data(lines, body, sep, mark, width, numeric)
    header = tuple(i for i in range(first) if lines[i].strip())
    return Layout(sep, mark, header, first, width, numeric)


def _headed(lines: Sequence[str], body: Sequence[int], separator: str, width: int, numbers: int) -> bool:
    """Whether an early line names every column, of which some hold numbers.

    Where cells hold lists, blanks or commas inside them may cut the rows into as many numbers as the right separator
    does; only that one cuts the header into as many names.
    """
    if width < 2 or not numbers:
        return False
    for index in body[:_SAMPLE]:
        cells = split(lines[index], separator)
        if len(cells) == width and all(number(c) is None for c in cells) and len(set(cells)) == width:
            return True
    return False


def said(lines: Sequence[str], first: int) -> list[int]:
    """Indices from `first` of the lines that are neither blank nor a comment."""
    return [
        i for i, line in enumerate(lines[first:], first) if (text := line.lstrip()) and not text.startswith(COMMENTS)
    ]


def is_comment(line: str) -> bool:
    """Whether the line is a comment."""
    return line.lstrip().startswith(COMMENTS)


def _plain(cell: str, decimal: str) -> bool:
    value = number(cell, decimal)
    return value is not None and value == value


def _first_data(
    lines: Sequence[str],
    body: Sequence[int],
    separator: str,
    decimal: str,
    width: int,
    numeric: Sequence[bool],
) -> int:
    """The first line that looks like the sample: as many cells, and numbers where the sample has numbers."""
    for index in body[:200]:
        cells = split(lines[index], separator)
        if len(cells) != width:
            continue
        values = [number(c, decimal) for c in cells]
        if (
            any(numeric)
            and all(v is not None for v, n in zip(values, numeric) if n)
            and any(v is not None and v == v for v, n in zip(values, numeric) if n)
        ):
            return index
    return body[0] if not any(numeric) else min(body[0] + 1, len(lines))


def column_names(lines: Sequence[str], layout: Layout) -> list[tuple[str, ...]]:
    """For each column the names that the header lines give it, those of the best header line first."""
    candidates: list[list[str]] = []
    for index in layout.header:
        line = lines[index]
        for mark in COMMENTS:
            line = line.strip().removeprefix(mark) if is_comment(lines[index]) else line
        cells = split(line, layout.separator)
        while len(cells) > layout.width and not cells[-1]:
            cells.pop()
        if len(cells) == layout.width and any(c and number(c) is None for c in cells):
            candidates.append(cells)
    candidates.sort(key=lambda cells: -len({c for c in cells if c and number(c) is None}))
    return [tuple(dict.fromkeys(c[j][:100] for c in candidates if c[j])) for j in range(layout.width)]
