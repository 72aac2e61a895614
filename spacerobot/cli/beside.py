"""Commands that follow one another in a process of their own, beside others: each compiles what it needs.

`python -m spacerobot.cli.beside COMMANDS` is that process: a JSON list of what is typed after `spacerobot`. It prints a
JSON string for each command, what that one said, as soon as it is done.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO

from spacerobot.support.errors import SpacerobotError
from spacerobot.support.orphans import leashed
from spacerobot.support.progress import Progress

_ROOT = str(Path(__file__).resolve().parents[2])

LOOK_EVERY = 0.1
"""Seconds between looks at what the process has said."""


class Beside:
    """Commands under way.

    Args:
        commands: each as typed after `spacerobot`.
        said: file for what they print.
        complained: file for their standard error.
    """

    def __init__(self, commands: Sequence[Sequence[str]], said: IO[str], complained: IO[str]) -> None:
        self._commands, self._said, self._complained = list(commands), said, complained
        path = os.pathsep.join(filter(None, [_ROOT, os.environ.get("PYTHONPATH")]))
        listed = json.dumps([list(c) for c in commands])
        self.process = subprocess.Popen(  # noqa: S603 - our own commands
            leashed([sys.executable, "-P", "-m", "spacerobot.cli.beside", listed]),
            stdout=said,
            stderr=complained,
            env={**os.environ, "PYTHONPATH": path},
        )

    def answer(self, number: int = 0) -> str:
        """What a command printed, once it is at its end; where it is meanwhile is told as its own.

        Raises:
            SpacerobotError: it failed; the message is its own.
        """
        name = f"spacerobot {self._commands[number][0]}"
        with Progress(name) as progress:
            while True:
                over = self.process.poll() is not None  # asked first: what is said afterwards is whole
                answers = self._lines(self._said)
                if len(answers) > number:
                    return str(json.loads(answers[number]))
                if over:
                    code = self.process.returncode
                    raise SpacerobotError(self._last_word() or f"{name} ended with exit code {code}")
                progress.call(self._last_word() or name)
                time.sleep(LOOK_EVERY)

    def _last_word(self) -> str:
        return next(iter(self._lines(self._complained)[::-1]), "")

    @staticmethod
    def _lines(file: IO[str]) -> list[str]:
        file.seek(0)
        return [line for line in file.read().split("\n")[:-1] if line]


@contextlib.contextmanager
def beside(*commands: Sequence[str]) -> Iterator[Beside]:
    """Begin commands that follow one another; whoever leaves before their end takes them along."""
    with contextlib.ExitStack() as files:
        said, complained = (files.enter_context(tempfile.TemporaryFile("w+", encoding="utf-8")) for _ in range(2))
        begun = Beside(commands, said, complained)
        try:
            yield begun
        finally:
            if begun.process.poll() is None:
                begun.process.terminate()
                begun.process.wait()


def _in_turn(commands: Sequence[Sequence[str]]) -> int:
    """Do the commands, up to the first that fails; its exit code."""
    from spacerobot.cli.main import main

    for command in commands:
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            code = main(command)
        if code:
            return code
        print(json.dumps(said.getvalue()), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(_in_turn(json.loads(sys.argv[1])))
