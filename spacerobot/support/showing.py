"""Records as people see them in Python: one short line at a prompt, a small table in a notebook."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

LONGEST = 48
"""Characters of a text or number of a record, and numbers of an array that is written out: what a line has room for."""

FEW = 7
"""Numbers of an array that are still written out: those of a pose."""


class Brief:
    """A record whose repr is one short line: arrays by their shapes, long fields by what they hold.

    The record is a dataclass; with repr=False this one is used.
    """

    def __repr__(self) -> str:
        shown = [f"{f.name}={brief(getattr(self, f.name))}" for f in dataclasses.fields(self) if f.repr]  # type: ignore[arg-type]
        return f"{type(self).__name__}({', '.join(shown)})"


def brief(value: Any) -> str:
    """A value in a few characters."""
    if isinstance(value, np.ndarray):
        if value.size <= FEW and value.dtype != object:
            return np.array2string(value, precision=4, separator=", ", max_line_width=10**6).replace("\n", "")
        return f"<array {' x '.join(map(str, value.shape))}>"
    if isinstance(value, Mapping):
        return f"<{len(value)} by name>" if value else "{}"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, np.floating):
        return f"{float(value):.6g}"
    if isinstance(value, tuple) and value and len(value) <= FEW and all(isinstance(v, float) for v in value):
        return f"({', '.join(f'{v:.4g}' for v in value)})"
    if isinstance(value, list | tuple) and len(repr(value)) > LONGEST:
        return f"<{len(value)} of them>"
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        text = repr(value)
        return text if len(text) <= LONGEST else f"{type(value).__name__}(...)"
    text = repr(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 4]}...{text[-1]}"


def html_table(title: str, rows: Iterable[Sequence[Any]], head: Sequence[str] = (), notes: Iterable[str] = ()) -> str:
    """A small table for a notebook; whatever is in it is escaped.

    Args:
        title: above the table.
        rows: cells, as text or numbers.
        head: of the columns.
        notes: sentences below.
    """
    lines = ['<div class="spacerobot"><p><b>', escape(title), "</b></p><table>"]
    if head:
        lines += ["<thead><tr>", *(f"<th>{escape(text)}</th>" for text in head), "</tr></thead>"]
    lines.append("<tbody>")
    for row in rows:
        cells = (f'<td style="text-align: {_side(cell)}">{escape(cell_text(cell))}</td>' for cell in row)
        lines += ["<tr>", *cells, "</tr>"]
    lines.append("</tbody></table>")
    lines += [f"<p>{escape(note)}</p>" for note in notes]
    return "".join([*lines, "</div>"])


def cell_text(value: Any) -> str:
    """A number with six digits, a dash for none, anything else as it says itself."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    if isinstance(value, bool | str):
        return str(value)
    if isinstance(value, float | np.floating):
        return "infinite" if math.isinf(value) else f"{float(value):.6g}"
    return str(value)


def _side(cell: Any) -> str:
    return "right" if isinstance(cell, int | float | np.number) and not isinstance(cell, bool) else "left"
