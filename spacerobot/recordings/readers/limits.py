"""Limits against hostile or broken files, and reading bytes within them."""

from __future__ import annotations

import bz2
import gzip
import lzma
import zlib
from pathlib import Path

from spacerobot.support.errors import InputError

TEXT_BYTES = 128_000_000
"""Longest text that is read, after decompression."""

TEXT_LINES = 3_000_000
"""Most lines of a text."""

LINE_CHARACTERS = 1_000_000
"""Longest line of a text."""

TEXT_MEMORY = 160_000_000
"""Most memory that the decoded text may take, bytes."""

TEXT_COLUMNS = 5000
"""Most columns of a text table."""

ARRAY_VALUES = 20_000_000
"""Most numbers that are taken from one file (160 MB)."""

BINARY_BYTES = 1_000_000_000
"""Longest binary file that is opened."""

CHILD_SECONDS = 60.0
"""Longest time that a child process may take over one binary file."""

CHILD_BYTES = 800_000_000
"""Most memory that a child process may add to its own while it reads."""

_MAGIC = ((b"\x1f\x8b", "gz"), (b"BZh", "bz2"), (b"\xfd7zXZ\x00", "xz"))
_BROKEN = (OSError, EOFError, zlib.error, lzma.LZMAError, ValueError)


def compression_of(head: bytes) -> str:
    """ "gz", "bz2", "xz" or "none", by the first bytes."""
    return next((name for magic, name in _MAGIC if head.startswith(magic)), "none")


def read_head(path: Path, count: int = 4096) -> bytes:
    """The first bytes, decompressed; as much of them as can be had.

    Raises:
        InputError: the file cannot be opened.
    """
    raw = read_bytes(path, count, compression="none", whole=False)
    kind = compression_of(raw)
    if kind == "none":
        return raw
    try:
        return read_bytes(path, count, compression=kind, whole=False)
    except InputError:
        return raw


def read_bytes(path: Path, limit: int = TEXT_BYTES, *, compression: str | None = None, whole: bool = True) -> bytes:
    """The file's bytes, decompressed, never more than `limit`.

    Args:
        path: the file.
        limit: most bytes after decompression.
        compression: "none", "gz", "bz2" or "xz"; None to go by the first bytes.
        whole: refuse a longer file, instead of returning its beginning.

    Raises:
        InputError: unreadable, broken, or longer than `limit`.
    """
    try:
        with path.open("rb") as stream:
            kind = compression or compression_of(stream.read(6))
            stream.seek(0)
            if kind == "gz":
                data = gzip.GzipFile(fileobj=stream).read(limit + 1)
            elif kind == "bz2":
                data = bz2.BZ2File(stream).read(limit + 1)
            elif kind == "xz":
                unpacker = lzma.LZMADecompressor(memlimit=200_000_000)
                data = unpacker.decompress(stream.read(limit + 1), limit + 1)
            else:
                data = stream.read(limit + 1)
    except _BROKEN as error:
        reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
        raise InputError(f"cannot be read: {reason}", where=str(path)) from None
    if len(data) > limit:
        if whole:
            raise InputError(
                "the file is too long",
                given=f"more than {limit} bytes once unpacked",
                valid=f"at most {limit} bytes",
                where=str(path),
            )
        return data[:limit]
    return data


def check_cells(path: Path, rows: int, columns: int) -> None:
    """Refuse a table of more cells than `ARRAY_VALUES`.

    Raises:
        InputError: with its size.
    """
    if rows * columns > ARRAY_VALUES:
        raise InputError(
            "the table is too large",
            given=f"{rows} rows of {columns} columns",
            valid=f"at most {ARRAY_VALUES} cells",
            where=str(path),
        )
