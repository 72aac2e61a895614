"""Writing files so that what is there is whole: temporary file, flush to disk, rename."""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import stat
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO, Any

from spacerobot.support.errors import InputError


@contextlib.contextmanager
def atomic(path: Path, mode: str = "w") -> Iterator[IO[Any]]:
    """Open a file that replaces `path` only if the block ends without an exception.

    Args:
        path: the file to write; its folder is made if it is missing. A link there is replaced, not followed.
        mode: "w" for text (UTF-8) or "wb" for bytes.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
    try:
        with os.fdopen(handle, mode, encoding=None if "b" in mode else "utf-8") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(name)
        raise


def write_text(path: Path, text: str) -> None:
    """Write `text` to `path`, whole or not at all."""
    with atomic(path) as stream:
        stream.write(text)


def read_toml_text(path: str | Path, what: str, most: int) -> str:
    """Text of a TOML file that a user names.

    Args:
        path: of the file.
        what: it describes, e.g. "scene".
        most: bytes that such a file has at most.

    Raises:
        InputError: it is missing, too large or no text.
    """
    file = Path(path)
    try:
        if not file.is_file():
            raise InputError(f"no such {what}", given=str(path), valid=f"a {what} in a TOML file")
        if file.stat().st_size > most:
            raise InputError(f"too large for a {what}", given=f"{file.stat().st_size} bytes", where=str(path))
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeError, ValueError) as error:
        raise InputError(f"the {what} cannot be read ({error})", given=str(path)) from None


def may_write(path: Path, what: str, overwrite: bool) -> None:
    """Refuse to write over what is there, were it a link that leads nowhere.

    Raises:
        InputError: something is there, and `overwrite` does not allow it.
    """
    if os.path.lexists(path) and not overwrite:
        raise InputError(f"{what} is there already", given=str(path), valid="another name, or --overwrite")


def left_over(paths: Iterable[Path]) -> list[Path]:
    """What `atomic` has left beside these files because its process was killed; only plain files of its own naming."""
    wanted: dict[Path, set[str]] = {}
    for path in paths:
        wanted.setdefault(path.parent, set()).add(path.name)
    found = []
    for folder, names in wanted.items():
        with contextlib.suppress(OSError):  # not there, not a folder, not ours to read
            for entry in os.scandir(folder):
                name = re.fullmatch(r"\.(.+)\.[a-z0-9_]{8}\.part", entry.name, re.DOTALL)
                if name is not None and name[1] in names and entry.is_file(follow_symlinks=False):
                    found.append(folder / entry.name)
    return found


def plain_file(path: Path) -> bool:
    """Whether a file lies there itself: no link, no folder, no device."""
    try:
        return stat.S_ISREG(path.lstat().st_mode)
    except (OSError, ValueError):
        return False


def sha256_of(path: Path) -> str:
    """SHA-256 of a file's content, in hexadecimal.

    Raises:
        OSError: it cannot be read.
    """
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
