"""Lines of a text file: encoding found, limits kept."""

from __future__ import annotations

import codecs
import contextlib
import re
import sys
from pathlib import Path

from spacerobot.recordings.readers import limits
from spacerobot.support.errors import InputError

_BOMS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


_HEAD = 100_000
"""Bytes by which an encoding is told."""


def decode(raw: bytes, path: Path, encoding: str | None = None) -> str:
    """`raw` as text: by its byte-order mark, else UTF-8, else the encoding of a country that it looks like.

    Raises:
        InputError: an unknown or wrong encoding, or bytes that are no text.
    """
    for mark, name in _BOMS:
        if raw.startswith(mark):
            encoding = "utf-8-sig" if name == "utf-8" else name
            break
    else:
        zero = raw.find(b"\0")
        if zero >= 0 and encoding is None:
            line = raw.count(b"\n", 0, zero) + 1
            raise InputError(
                "binary data, or UTF-16 without its mark, in a text file",
                valid='encoding = "utf-16-le"?',
                where=f"{path}:{line}",
            )
    try:
        if encoding:
            return raw.decode(encoding)
        try:
            return raw.decode("utf-8")
        except UnicodeDecodeError:
            return raw.decode(_local(raw[:_HEAD]), "replace")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise InputError(f"not {encoding} text", where=f"{path}:{line}") from None
    except (LookupError, ValueError):
        raise InputError(
            "unknown encoding", given=encoding, valid="utf-8, utf-16, latin-1, ...", where=str(path)
        ) from None


def _local(head: bytes) -> str:
    """The encoding of text that is no UTF-8: Shift-JIS or GB 2312 where every character comes out, else Latin-1.

    Latin letters with marks stand alone between plain ones; the characters of those two come in pairs of bytes, of
    which Shift-JIS begins many with what Latin-1 uses for nothing.
    """
    high = re.findall(rb"[\x80-\xff]+", head)
    east = [("gb2312", all(len(run) % 2 == 0 for run in high[:-1])), ("cp932", any(c < 0xA0 for c in b"".join(high)))]
    for encoding, likely in east:
        text = ""
        if likely:
            with contextlib.suppress(UnicodeDecodeError):
                text = codecs.getincrementaldecoder(encoding)().decode(head)
        if text and sum(map(_written, text)) > 0.9 * sum(c > "\x7f" for c in text):
            return encoding
    return "latin-1"


def _written(character: str) -> bool:
    return "\u3040" <= character <= "\u30ff" or "\u4e00" <= character <= "\u9fff" or character in "「」（）・％"


def read_lines(path: Path, compression: str | None = None, encoding: str | None = None) -> list[str]:
    """The lines of a text file, without their ends (LF, CRLF or CR).

    Raises:
        InputError: unreadable, too long, too many lines, or a line too long.
    """
    raw = limits.read_bytes(path, compression=compression)
    text = decode(raw, path, encoding)
    del raw
    if sys.getsizeof(text) > limits.TEXT_MEMORY:
        raise InputError("the text takes too much memory", valid=f"at most {limits.TEXT_MEMORY} bytes", where=str(path))
    if "\r" in text:
        text = text.replace("\r\n", "\n")
        text = text.replace("\r", "\n")
    if text.count("\n") > limits.TEXT_LINES:
        raise InputError("too many lines", valid=f"at most {limits.TEXT_LINES}", where=str(path))
    lines = text.split("\n")
    if lines and not lines[-1]:
        lines.pop()
    if len(text) > limits.LINE_CHARACTERS < max(map(len, lines), default=0):
        number, line = next(found for found in enumerate(lines, start=1) if len(found[1]) > limits.LINE_CHARACTERS)
        raise InputError(
            "the line is too long",
            given=f"{len(line)} characters",
            valid=f"at most {limits.LINE_CHARACTERS}",
            where=f"{path}:{number}",
        )
    return lines
