"""Finding out how a delimited text is laid out: separator, decimal mark, header, columns."""

from __future__ import annotations

import contextlib
import csv
import re
from bisect import bisect_left
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from operator import itemgetter

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.numbers import number
from spacerobot.recordings.units import UNITS
from spacerobot.support.errors import InputError

COMMENTS = ("#", "%", "//")
_SILENT = frozenset(mark[0] for mark in COMMENTS)
_FIRST = itemgetter(0)

_CANDIDATES = (
    (";", "."),
    (";", ","),
    ("\t", "."),
    ("\t", ","),
    (",", "."),
    ("|", "."),
    (" ", "."),
    (" ", ","),
    (",", ","),
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
        rows: indices of the data lines: all from the first on that are neither blank nor a comment.
        width: cells of a data line.
        numeric: per column, whether its cells are numbers.
    """

    separator: str
    decimal: str
    header: tuple[int, ...]
    rows: Sequence[int]
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
        return Layout(separator or ",", decimal or ".", (), (), 0, ())
    half = len(body) // 2 if header_rows is None else 0
    sample = [lines[i] for i in body[half : half + _SAMPLE]]
    sample = [line for line in sample if not _WORD.search(line)] or sample
    best: tuple[tuple[bool, float, int], str, str, int, tuple[bool, ...]] | None = None
    together = "".join(sample)
    undivided = False
    for sep, mark in _CANDIDATES:
        if (separator is not None and sep != separator) or (decimal is not None and mark != decimal):
            continue
        absent = len(together.split()) < 2 if sep == " " else sep not in together
        if sep == mark and '"' not in together:
            continue  # a comma of both kinds is told apart by quotes alone
        if absent and undivided:
            continue  # one column again, as under the other absent separator
        undivided = undivided or absent
        width, agreeing, numeric = _cut(sample, sep, mark)
        if width == 1 and mark == "," and decimal is None:
            continue  # "1,5" alone is two columns, unless the study says otherwise
        good = sum(numeric) / width * agreeing / len(sample)
        key = (_headed(lines, body[:half], sep, width, sum(numeric)), round(good, 2), sum(numeric))
        if best is None or key > best[0]:
            best = (key, sep, mark, width, numeric)
    if best is None:
        best = ((False, 0.0, 0), separator or ",", decimal or ".", len(split(sample[0], separator or ",")), ())
    _, sep, mark, width, numeric = best
    first = start if header_rows is not None else _first_data(lines, body, sep, mark, width, numeric)
    header = tuple(i for i in range(first) if lines[i].strip())
    return Layout(sep, mark, header, body[bisect_left(body, first) :], width, numeric)


def _cut(sample: Sequence[str], separator: str, decimal: str) -> tuple[int, int, tuple[bool, ...]]:
    """The sample under one layout: its usual width, how many lines have it, and which columns of these are numbers.

    Raises:
        InputError: more columns than the limit.
    """
    from spacerobot.recordings.readers.decimals import decimals  # takes a moment to load

    width = len(split(sample[0], separator))
    if width <= limits.TEXT_COLUMNS and decimals(sample, separator, width) is not None:
        return width, len(sample), (True,) * width
    rows = [split(line, separator) for line in sample]
    if max(map(len, rows)) > limits.TEXT_COLUMNS:
        raise InputError("too many columns", valid=f"at most {limits.TEXT_COLUMNS}")
    width, agreeing = Counter(map(len, rows)).most_common(1)[0]
    columns = [[number(r[j], decimal) for r in rows if len(r) == width] for j in range(width)]
    numeric = (len(c) - c.count(None) >= 0.9 * len(c) and any(v is not None and v == v for v in c) for c in columns)
    return width, agreeing, tuple(numeric)


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


def _grouped(lines: Sequence[Sequence[str]]) -> list[list[str]]:
    """A line of whole names, "target.X", where one has a thing above the first of its columns and one its axes."""
    for i, parts in enumerate(lines):
        told = [c for c in parts if c and number(c) is None]
        for groups in lines[:i]:
            heads = [c for c in groups if c]
            if not 1 < len(heads) < len(told) or len(set(told)) == len(told) or len(set(heads)) < len(heads):
                continue
            whole, above = [], ""
            for group, part in zip(groups, parts, strict=True):
                above = group or above
                whole.append(f"{above}.{part}" if above and part else part)
            if len({c for c in whole if c}) > len(set(told)):
                return [whole]
    return []


def said(lines: Sequence[str], first: int) -> Sequence[int]:
    """Indices from `first` of the lines that are neither blank nor a comment."""
    with contextlib.suppress(IndexError):  # of an empty line
        beginnings = set(map(_FIRST, islice(lines, first, None)))
        if not any(c in _SILENT or c.isspace() for c in beginnings):
            return range(first, len(lines))
    return [
        i for i, line in enumerate(lines[first:], first) if (text := line.lstrip()) and not text.startswith(COMMENTS)
    ]


def is_comment(line: str) -> bool:
    """Whether the line is a comment."""
    return line.lstrip().startswith(COMMENTS)


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


def column_heads(lines: Sequence[str], layout: Layout) -> tuple[list[tuple[str, ...]], list[str | None]]:
    """For each column the names that the header lines give it, those of the best header line first, and its unit."""
    candidates: list[list[str]] = []
    for index in layout.header:
        line = lines[index]
        for mark in COMMENTS:
            line = line.strip().removeprefix(mark) if is_comment(lines[index]) else line
        cells = split(line, layout.separator)
        while len(cells) > layout.width and (not cells[-1] or index == layout.header[-1]):
            cells.pop()  # of the line above the numbers also names of what no row has
        if len(cells) == layout.width and any(c and number(c) is None for c in cells):
            above = [split(lines[i], layout.separator) for i in layout.header if i < index]
            candidates += [cells, *_repeated(cells, above), *_carried_on(cells)]
    return headings(candidates, layout.width)


def _repeated(cells: Sequence[str], above: Sequence[Sequence[str]]) -> list[list[str]]:
    """Whole names of a header that says the same of each thing, "X Y Z X Y Z", by a line above that names as many.

    Such a line begins with what it lists: "BODY_NAMES target slider".
    """
    for label, *things in above:
        while things and not things[-1]:
            things.pop()
        own, rest = divmod(len(cells), len(things) or 1)
        told = all(t and number(t) is None for t in things) and len(set(things)) == len(things) > 1
        if label and told and own > 1 and not rest and [*cells] == [*cells[:own]] * len(things):
            return [[f"{things[j // own]}.{cell}" for j, cell in enumerate(cells)]]
    return []


def _carried_on(cells: Sequence[str]) -> list[list[str]]:
    """Whole names of a header that says each thing once, with its first column: "target X", Y, Z, "wrist X", Y, Z."""
    parts = [cell.rsplit(maxsplit=1) for cell in cells]
    for first in dict.fromkeys(p[1] for p in parts if len(p) > 1):
        starts = [j for j, p in enumerate(parts) if len(p) > 1 and p[1] == first]
        own = starts[1] - starts[0] if len(starts) > 1 else 0
        rest = [*cells[starts[0] + 1 : starts[0] + own]]
        alike = all([*cells[j + 1 : j + own]] == rest for j in starts)
        if own > 1 and all(rest) and alike and starts == [starts[0] + own * k for k in range(len(starts))]:
            whole = [*cells]
            for j in starts:
                whole[j : j + own] = [f"{parts[j][0]}.{c}" for c in (first, *rest)]
            return [whole]
    return []


def headings(lines: Sequence[Sequence[str]], width: int) -> tuple[list[tuple[str, ...]], list[str | None]]:
    """What the lines above the numbers say of each column: its names, the best line's first, and its unit.

    A line that holds nothing but units, in brackets or not, states them where another line has the names.
    """
    units: list[str | None] = [None] * width
    named = []
    for cells in lines:
        bare = [c.strip("[]() ") for c in cells]
        words = [c for c in bare if c]
        labelled = len(words) > 2 and bool(bare[0]) and bare[0] not in UNITS  # "Unit", s, mm
        if len(lines) > 1 and words and all(c in UNITS for c in words[labelled:]) and not any(units):
            units = [c if c in UNITS else None for c in bare]
        else:
            named.append(cells)
    if not named:
        named, units = list(lines), [None] * width
    named = [*named, *_grouped(named)]
    named.sort(key=lambda cells: -len({c for c in cells if c and number(c) is None}))
    return [tuple(dict.fromkeys(c[j][:100] for c in named if c[j])) for j in range(width)], units
