"""What a reader may not do while it reads, and finding out that it did."""

from __future__ import annotations

import atexit
import contextlib
import os
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy

import spacerobot
from spacerobot.recordings.readers.decimals import decimals
from spacerobot.support.errors import InputError, SpacerobotError

SECONDS = 10.0
"""A case that takes longer is a finding."""

SCRATCH = "FUZZ_SCRATCH"
"""Environment variable: where the scratch folders go. The parent removes them, for libFuzzer leaves without a word."""

_FORBIDDEN = ("socket.connect", "socket.bind", "socket.getaddrinfo", "subprocess.Popen", "os.system", "os.exec",
              "os.posix_spawn", "os.fork", "pickle.find_class")  # fmt: skip
_CHANGES = ("os.remove", "os.rename", "os.mkdir", "os.rmdir", "os.symlink", "os.link", "os.chmod", "os.truncate")
_WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC


class Breach(BaseException):
    """The reader did what no reader may; not an Exception, so that no handler of the reader hides it."""


class Watch:
    """An audit hook over the reading of one input at a time: files outside the folder, sockets, processes, time.

    Args:
        folder: the only one in which files may be read and written; the installation's own may be read.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = str(folder.resolve())
        decimals(["0"], ",", 1)  # compiled, or read from the user's cache, before anybody watches
        checkout = Path(spacerobot.__file__).resolve().parents[1]
        own = (Path(sys.prefix), Path(sys.base_prefix), checkout / "spacerobot", checkout / "urdf")
        self.readable = (*(str(p.resolve()) for p in own), str(Path(numpy.__file__).parents[1]), "/proc/", "/dev/null")
        self.readable += ("/etc/ld.so", "/usr/lib", "/etc/mime.types")
        self._on = False
        self._breach = ""
        sys.addaudithook(self._hook)
        signal.signal(signal.SIGALRM, self._late)

    def case(self, read: Callable[[bytes], None], data: bytes) -> tuple[str, str, float]:
        """Read one input.

        Returns:
            "read" or "refused" or "defect", the defect's words (the same for the same defect), seconds of CPU.
        """
        self._breach = ""
        start = time.process_time()
        outcome, words = "read", ""
        try:
            with self._watching():
                read(data)
        except InputError as error:
            outcome = "refused"
            if len(str(error)) > 3000 or not str(error).isprintable():
                outcome, words = "defect", f"a message that is too long or unprintable, {signature(error)[:80]}"
        except (KeyboardInterrupt, SystemExit):
            raise
        except SpacerobotError as error:
            outcome, words = "defect", f"{type(error).__name__}: {error}"[:200]
        except BaseException as error:  # whatever it is, it is what the fuzzer is after
            outcome, words = "defect", signature(error)
        if self._breach:
            outcome, words = "defect", self._breach
        return outcome, words, time.process_time() - start

    @contextlib.contextmanager
    def _watching(self) -> Iterator[None]:
        signal.setitimer(signal.ITIMER_REAL, 6 * SECONDS)
        self._on = True
        try:
            yield
        finally:
            self._on = False
            signal.setitimer(signal.ITIMER_REAL, 0)

    def _late(self, *_: object) -> None:
        if self._on:
            raise Breach("took too long")

    def _hook(self, event: str, args: tuple[Any, ...]) -> None:
        if not self._on:
            return
        if event == "open" and isinstance(args[0], str | bytes):
            self._opened(os.fsdecode(args[0]), args[1], args[2])
        elif event in _FORBIDDEN:
            self._fail(event)
        elif event in _CHANGES and not self._inside(_placed(args)):
            self._fail(f"{event} outside: {_placed(args)[:80]}")

    def _opened(self, path: str, mode: str | None, flags: int) -> None:
        if self._inside(path) or os.path.basename(path).startswith("<"):
            return  # "<string>": a traceback that looks for the source of code without a file
        writes = bool(flags & _WRITING) or any(c in (mode or "") for c in "wax+")
        real = os.path.realpath(path)
        if (writes and real != os.devnull) or not real.startswith(self.readable):
            self._fail(f"{'writes' if writes else 'reads'} outside its folder: {real[:80]}")

    def _inside(self, path: str) -> bool:
        return os.path.realpath(path).startswith(self.folder)

    def _fail(self, what: str) -> None:
        self._breach = self._breach or what
        raise Breach(what)


def _placed(args: tuple[Any, ...]) -> str:
    """The path of an audit event, which may be relative to an open folder."""
    path = os.fsdecode(args[0]) if not isinstance(args[0], int) else f"/proc/self/fd/{args[0]}"
    opened = [a for a in args[1:] if isinstance(a, int) and a > 2 and os.path.isdir(f"/proc/self/fd/{a}")]
    return path if path.startswith("/") or not opened else f"/proc/self/fd/{opened[-1]}/{path}"


def scratch(name: str) -> Path:
    """A new folder, in memory where that can be had (a million files are no good to a disk); gone when we are."""
    memory = "/dev/shm" if os.path.isdir("/dev/shm") else None
    folder = Path(tempfile.mkdtemp(prefix=f"fuzz-{name}-", dir=os.environ.get(SCRATCH, memory)))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def signature(error: BaseException) -> str:
    """The kind of an error and where in our code it came from; the same for the same defect."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [f for f in frames if "/spacerobot/" in f.filename] or frames[-1:]
    places = " < ".join(f"{Path(f.filename).name}:{f.lineno}" for f in reversed(ours[-3:]))
    return f"{type(error).__name__} at {places}: {str(error)[:100]}"
