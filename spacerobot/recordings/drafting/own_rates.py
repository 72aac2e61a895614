"""Arrays of one file that were logged at rates of their own: each clock with the readings that are as many."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.languages import words_in
from spacerobot.recordings.guess import find_time
from spacerobot.recordings.table import RawTable


def by_rate(file: Found) -> list[Found]:
    """The file's readings apart by their number, where two numbers at least have a clock; else the file.

    Each is called by the struct or group that sets it apart, or by its first reading.
    """
    lengths = list(dict.fromkeys(len(file.table.columns[j].values) for j in file.usable))
    parts = [p for n in lengths if (p := _part(file, [j for j in file.usable if _rows(file, j) == n])) is not None]
    if len(parts) < 2 or file.labels:
        return [file]
    paths = [_first(p).split(".") for p in parts]
    depth = next((k for k, own in enumerate(zip(*paths, strict=False)) if len(set(own)) > 1), 0)
    calls = [words_in(path[depth])[:1] for path in paths]
    return [replace(p, named=replace(p.named, words=(*p.named.words, *w))) for p, w in zip(parts, calls, strict=True)]


def _rows(file: Found, column: int) -> int:
    return len(file.table.columns[column].values)


def _part(file: Found, own: Sequence[int]) -> Found | None:
    """Some columns as a file; None without a clock, or with nothing else."""
    columns = tuple(file.table.columns[j] for j in own)
    table = RawTable(file.table.path, columns, None, file.table.notes, file.table.stated)
    clock = find_time(table)
    if clock is None or len(columns) < 2:
        return None
    return replace(file, table=table, usable=tuple(range(len(columns))), rate=None)


def _first(part: Found) -> str:
    """The name of its first reading."""
    return next((c.names[0] for j, c in enumerate(part.table.columns) if j != part.clock and c.names), "")
