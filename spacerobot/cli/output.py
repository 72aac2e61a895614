"""Standard output as people see it: lines that fit the terminal, and a stream that is there even where none is."""

from __future__ import annotations

import os
import shutil
import sys
import textwrap
from typing import Any, TextIO

NARROWEST = 20
"""Columns below which lines are not broken any more: no table says anything there."""

UNSAID = "80"
"""What COLUMNS says in every child of a process without a terminal that has loaded readline: nobody asked for it."""


class Fitted:
    """A text stream that breaks lines at the terminal's width; all else is the stream's own.

    Args:
        stream: where the text goes.
        width: columns.
    """

    def __init__(self, stream: TextIO, width: int) -> None:
        self._stream, self._width, self._begun = stream, width, ""

    def write(self, text: str) -> int:
        """Write the lines that are whole; keep the last one until it is."""
        *lines, self._begun = (self._begun + text).split("\n")
        for line in lines:
            self._stream.write(fitted(line, self._width) + "\n")
        return len(text)

    def flush(self) -> None:
        """Write what was kept too."""
        begun, self._begun = self._begun, ""
        self._stream.write(fitted(begun, self._width))
        self._stream.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def fitted(line: str, width: int) -> str:
    """A line as lines of at most `width` columns, broken at spaces where that goes, the further ones set in."""
    if len(line) <= width:
        return line
    indent = len(line) - len(line.lstrip(" "))
    further = " " * min(indent + 2, width // 3)
    wrapped = textwrap.wrap(
        line,
        width,
        initial_indent="",
        subsequent_indent=further,
        expand_tabs=False,
        replace_whitespace=False,
        break_on_hyphens=False,
    )
    return "\n".join(wrapped)


def width() -> int | None:
    """Columns of the terminal that reads standard output, or that COLUMNS claims; None where nobody says."""
    claimed = os.environ.get("COLUMNS", "")
    if not sys.stdout.isatty() and (not claimed.isdigit() or claimed == UNSAID):
        return None
    found = shutil.get_terminal_size().columns
    return found if found >= NARROWEST else None


def open_streams() -> None:
    """Give a process that began with closed standard streams streams that lead nowhere.

    Else the first file that is opened takes the place of standard output, and Python's own streams are None.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest that is free: this one
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - for as long as the process lasts
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
