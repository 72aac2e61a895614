"""Folders for a moment, that are cleared away even where the process that made them was killed."""

from __future__ import annotations

import contextlib
import fcntl
import functools
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

_MARK = "spacerobot-scratch-"


@contextlib.contextmanager
def scratch(prefix: str = "") -> Iterator[Path]:
    """A fresh folder in the system's temporary folder, gone after the block.

    Whoever is killed in the block leaves it lying; the first `scratch` of a later process clears it away. Its owner
    holds a lock on the folder, which the kernel drops with the process: what is locked is in use, whoever asks.

    Args:
        prefix: what it is for, in its name.
    """
    _cleared(tempfile.gettempdir())
    folder, lock = _made(f"{_MARK}{prefix}-" if prefix else _MARK)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(lock)


def clear(where: Path) -> list[Path]:
    """Remove this user's scratch folders in `where` whose owners are gone; returns them."""
    found = []
    for folder in where.glob(f"{_MARK}*"):
        with contextlib.suppress(OSError):  # somebody else's, a link, or just cleared by another
            lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
            try:
                if os.fstat(lock).st_uid != os.geteuid():
                    continue
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(folder, ignore_errors=True)
                found.append(folder)
            finally:
                os.close(lock)
    return found


@functools.cache
def _cleared(where: str) -> None:
    """Once a process: nobody leaves many, and the folder is everybody's."""
    clear(Path(where))


def _made(prefix: str) -> tuple[Path, int]:
    while True:
        folder = Path(tempfile.mkdtemp(prefix=prefix)).resolve()
        lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        with contextlib.suppress(OSError):  # a file system without locks: nobody else can take it either
            fcntl.flock(lock, fcntl.LOCK_EX)
        if folder.is_dir():  # else another process took it for a dead one's before it was locked
            return folder, lock
        os.close(lock)
