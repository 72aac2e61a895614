"""Arrays of one file that were logged at rates of their own: each clock with the readings that are as many."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.languages import words_in
from spacerobot.recordings.guess import find_time
from spacerobot.recordings.table import RawTable


def by_rate(file: Found) -> list[Found]:
    """The file's readings apart by their number, where two numbers at least have a clock; else the file."""
    lengths = list(dict.fromkeys(len(file.table.columns[j].values) for j in file.usable))
    parts = [p for n in lengths if (p := _part(file, [j for j in file.usable if _rows(file, j) == n])) is not None]
    return parts if len(parts) > 1 and not file.labels else [file]


def _rows(file: Found, column: int) -> int:
    return len(file.table.columns[column].values)


def _part(file: Found, own: Sequence[int]) -> Found | None:
    """Some columns as a file, called by its first reading; None without a clock, or with nothing else."""
    columns = tuple(file.table.columns[j] for j in own)
    table = RawTable(file.table.path, columns, None, file.table.notes, file.table.stated)
    clock = find_time(table)
    if clock is None or len(columns) < 2:
        return None
    name = next((c.names[0] for j, c in enumerate(columns) if j != clock and c.names), "")
    words = (*file.named.words, *words_in(name)[:1])
    return replace(
        file, table=table, usable=tuple(range(len(columns))), named=replace(file.named, words=words), rate=None
    )
