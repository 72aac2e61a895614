"""Stamps that a log keeps in two columns, whole seconds and nanoseconds, as one column of seconds."""

from __future__ import annotations

import re
from dataclasses import replace

from spacerobot.recordings.table import Column, RawTable

_SECONDS = re.compile(r"(?P<stem>.*?)[._/ ]?secs?(?:onds)?", re.IGNORECASE)
_NANOSECONDS = re.compile(r"(?P<stem>.*?)[._/ ]?n(?:ano)?secs?(?:onds)?", re.IGNORECASE)


def with_stamps(table: RawTable) -> RawTable:
    """The table with a column "header.stamp" [s] behind the others, where it has header.stamp.secs and .nsecs."""
    whole: dict[str, Column] = {}
    parts: dict[str, Column] = {}
    for column in table.columns:
        for name in column.names[:1]:
            if match := _NANOSECONDS.fullmatch(name):
                parts[match["stem"]] = column
            elif match := _SECONDS.fullmatch(name):
                whole[match["stem"]] = column
    taken = {name for column in table.columns for name in column.names}
    made = [
        Column((stem or "stamp",), whole[stem].values + 1e-9 * parts[stem].values, "s")
        for stem in whole
        if stem in parts and (stem or "stamp") not in taken and whole[stem].values.shape == parts[stem].values.shape
    ]
    return replace(table, columns=(*table.columns, *made)) if made else table
