"""A TOML file with the line of every key, so that errors can point at what was written."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spacerobot.support.errors import InputError, NotFoundError

LARGEST = 1e15
"""No physical value of a rig, in SI units, is beyond it."""

MAXIMUM_BYTES = 4_000_000
"""Longest study file that is read; a campaign of 300 trials takes about 50 kB."""

DEEPEST = 12
"""Most levels of tables and lists in a study."""

MOST_DOTS = 200
"""Dots in a table's name above which it is not even parsed; quoted names may hold some."""

_HEADER = re.compile(r"^\s*(\[\[?)([^\]]+)\]")
_KEY = re.compile(
    r"""^\s*((?:"[^"\n]*"|'[^'\n]*'|[A-Za-z0-9_-]+)(?:\s*\.\s*(?:"[^"\n]*"|'[^'\n]*'|[A-Za-z0-9_-]+))*)\s*="""
)
_PART = re.compile(r""""([^"\n]*)"|'([^'\n]*)'|([A-Za-z0-9_-]+)""")


@dataclass(frozen=True)
class Document:
    """A parsed TOML file.

    Attributes:
        path: the file.
        data: its tables.
        lines: dotted key (an array's element by its index) -> line, from 1; quoted or nested makes no difference.
    """

    path: Path
    data: dict[str, Any]
    lines: Mapping[str, int]

    def where(self, *keys: str | int) -> str:
        """`file:line` of the key at this path, or of its nearest written ancestor."""
        dotted = _dotted(keys)
        while dotted:
            if dotted in self.lines:
                return f"{self.path}:{self.lines[dotted]}"
            dotted = dotted.rpartition(".")[0]
        return str(self.path)

    def check_keys(self, table: Mapping[str, Any], known: Iterable[str], *path: str | int) -> None:
        """Refuse any key of `table` that is not `known`, naming the nearest known one and the line."""
        names = tuple(known)
        for key in table:
            if key not in names:
                raise NotFoundError("key", key, names, where=self.where(*path, key))

    def table(self, parent: Mapping[str, Any], key: str, *path: str | int) -> dict[str, Any]:
        """The table `key` of `parent`, empty if absent; anything but a table is refused."""
        value = parent.get(key, {})
        if not isinstance(value, dict):
            raise InputError(f"{key!r} must be a table", given=value, where=self.where(*path, key))
        return value

    def text(self, table: Mapping[str, Any], key: str, default: str, *path: str | int) -> str:
        """The string `key` of `table`."""
        value = table.get(key, default)
        if not isinstance(value, str):
            raise InputError(f"{key!r} must be text", given=value, where=self.where(*path, key))
        return value

    def flag(self, table: Mapping[str, Any], key: str, *path: str | int) -> bool:
        """The truth value `key` of `table`, false if absent."""
        value = table.get(key, False)
        if not isinstance(value, bool):
            raise InputError(f"{key!r} must be true or false", given=value, where=self.where(*path, key))
        return value

    def number(self, value: object, *path: str | int) -> float:
        """`value` as a finite float."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{path[-1]!r} must be a number", given=value, where=self.where(*path))
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise InputError(f"{path[-1]!r} must be finite", given=value, where=self.where(*path))
        if abs(number) > LARGEST:
            where = self.where(*path)
            raise InputError(f"{path[-1]!r} is out of range", given=value, valid=f"up to {LARGEST:g}", where=where)
        return number

    def vector(self, value: object, length: int | None, *path: str | int) -> tuple[float, ...]:
        """`value` as `length` finite floats (any number of them for None)."""
        if not isinstance(value, list) or (length is not None and len(value) != length):
            count = "a list of numbers" if length is None else f"a list of {length} numbers"
            raise InputError(f"{path[-1]!r} must be {count}", given=value, where=self.where(*path))
        return tuple(self.number(v, *path) for v in value)


def read_document(path: Path) -> Document:
    """Parse the TOML file at `path`.

    Raises:
        InputError: missing, too long, not UTF-8 or not TOML; with the line where the parser stopped.
    """
    try:
        if path.stat().st_size > MAXIMUM_BYTES:
            raise InputError(
                "the file is too long for a study", valid=f"at most {MAXIMUM_BYTES} bytes", where=str(path)
            )
        raw = path.read_bytes()
    except (OSError, ValueError) as error:
        raise InputError(f"cannot be read: {getattr(error, 'strerror', error)}", where=str(path)) from None
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise InputError(
            "a study must be UTF-8 text", given=f"byte {raw[error.start]:#04x}", where=f"{path}:{line}"
        ) from None
    text = text.replace("\r\n", "\n")
    for number, row in enumerate(text.split("\n"), 1):  # the parser's time grows with the square of the dots
        key = row.lstrip() if row.lstrip().startswith("[") and "," not in row else row.partition("=")[0]
        if ("=" in row or key.startswith("[")) and key.count(".") > MOST_DOTS:
            raise InputError("a key is nested too deep", valid=f"at most {DEEPEST} levels", where=f"{path}:{number}")
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        found = re.search(r"line (\d+)", str(error))
        where = f"{path}:{found.group(1)}" if found else str(path)
        raise InputError(f"not valid TOML: {error}", where=where) from None
    except (RecursionError, ValueError, OverflowError) as error:
        raise InputError(f"not valid TOML: {type(error).__name__}", where=str(path)) from None
    if _deeper(data, DEEPEST):
        raise InputError("tables are nested too deep", valid=f"at most {DEEPEST} levels", where=str(path))
    return Document(path, data, scan_lines(text))


def _deeper(data: dict[str, Any], levels: int) -> bool:
    """Whether tables and lists go deeper than `levels`, found without recursion."""
    layer: list[Any] = [data]
    for _ in range(levels):
        layer = [v for t in layer for v in (t.values() if isinstance(t, dict) else t) if isinstance(v, dict | list)]
    return bool(layer)


def scan_lines(text: str) -> dict[str, int]:
    """Line of each header and key of a TOML text: a light scan, exact for one key a line."""
    lines: dict[str, int] = {}
    counts: dict[tuple[str | int, ...], int] = {}
    prefix: tuple[str | int, ...] = ()
    for number, line in enumerate(text.split("\n"), start=1):
        header = _HEADER.match(line)
        if header:
            prefix = _resolve(_parts(header.group(2)), counts, new=header.group(1) == "[[")
            lines.setdefault(_dotted(prefix), number)
            continue
        key = _KEY.match(line)
        if key:
            parts = _parts(key.group(1))
            for end in range(1, len(parts) + 1):
                lines.setdefault(_dotted(prefix + parts[:end]), number)
    return lines


def _dotted(keys: tuple[str | int, ...]) -> str:
    return ".".join(map(str, keys))


def _parts(dotted: str) -> tuple[str, ...]:
    return tuple(a or b or c for a, b, c in _PART.findall(dotted))


def _resolve(parts: tuple[str, ...], counts: dict[tuple[str | int, ...], int], *, new: bool) -> tuple[str | int, ...]:
    path: tuple[str | int, ...] = ()
    for position, part in enumerate(parts):
        path += (part,)
        if new and position == len(parts) - 1:
            counts[path] = counts.get(path, -1) + 1
        if path in counts:
            path += (counts[path],)
    return path


def flatten(table: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested tables and quoted dotted keys alike as one flat dict by dotted name.

    Raises:
        InputError: one name written twice, once nested and once quoted.
    """
    flat: dict[str, Any] = {}
    for key, value in table.items():
        name = f"{prefix}{key}"
        found = flatten(value, f"{name}.") if isinstance(value, dict) else {name: value}
        for inner, leaf in found.items():
            if inner in flat:
                raise InputError("the same name is written twice, nested and dotted", given=inner)
            flat[inner] = leaf
    return flat
