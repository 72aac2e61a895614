"""A command in a process of its own, beside what this one does: on a fresh machine each compiles what it needs."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO

from spacerobot.support.errors import SpacerobotError
from spacerobot.support.orphans import leashed
from spacerobot.support.progress import Progress

_ROOT = str(Path(__file__).resolve().parents[2])


class Beside:
    """A command under way.

    Args:
        command: as typed after `spacerobot`.
        said: file for what it prints.
        complained: file for its standard error.
    """

    def __init__(self, command: Sequence[str], said: IO[str], complained: IO[str]) -> None:
        self.command, self._said, self._complained = list(command), said, complained
        path = os.pathsep.join(filter(None, [_ROOT, os.environ.get("PYTHONPATH")]))
        self.process = subprocess.Popen(  # noqa: S603 - our own command
            leashed([sys.executable, "-P", "-m", "spacerobot", *command]),
            stdout=said,
            stderr=complained,
            env={**os.environ, "PYTHONPATH": path},
        )

    def answer(self) -> str:
        """What it printed, once it is at its end.

        Raises:
            SpacerobotError: it failed; the message is its own.
        """
        with Progress(f"spacerobot {self.command[0]}"):
            failed = self.process.wait()
        for file in (self._said, self._complained):
            file.seek(0)
        if failed:
            last = self._complained.read().strip().rpartition("\n")[2]
            raise SpacerobotError(last or f"spacerobot {self.command[0]} ended with exit code {failed}")
        return self._said.read()


@contextlib.contextmanager
def beside(command: Sequence[str]) -> Iterator[Beside]:
    """Begin a command; whoever leaves before its end takes it along."""
    with contextlib.ExitStack() as files:
        said, complained = (files.enter_context(tempfile.TemporaryFile("w+", encoding="utf-8")) for _ in range(2))
        begun = Beside(command, said, complained)
        try:
            yield begun
        finally:
            if begun.process.poll() is None:
                begun.process.terminate()
                begun.process.wait()
