"""Processes that end with the process that began them, however that one ended.

`python -m spacerobot.support.orphans PARENT COMMAND ...` runs a command that does so; `leashed` writes that line.
"""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
from collections.abc import Sequence

_PR_SET_PDEATHSIG = 1
_LOOK_EVERY = 0.5
"""Seconds between looks at the parent where the kernel does not tell."""


def end_with_parent(parent: int | None = None) -> None:
    """In a child process: ask the kernel for SIGTERM when the parent is gone, even if it was killed.

    A worker of a pool waits for its next task on a pipe that it holds open itself, so it would wait for ever. On
    systems other than Linux this does nothing.

    Args:
        parent: its process id; whoever is the parent now if None.
    """
    if not sys.platform.startswith("linux"):
        return
    parent = os.getppid() if parent is None else parent
    ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)
    if os.getppid() != parent:  # it went while we asked
        os.kill(os.getpid(), signal.SIGTERM)


def leashed(command: Sequence[str]) -> list[str]:
    """The command line by which this process begins a command that is not to outlive it."""
    return [sys.executable, "-P", "-m", "spacerobot.support.orphans", str(os.getpid()), *command]


def become(command: Sequence[str], parent: int) -> None:
    """Turn this process into the command; the kernel's promise outlasts that."""
    end_with_parent(parent)
    os.execvp(command[0], list(command))  # noqa: S606 - our caller's own command


def watch_over(command: Sequence[str], parent: int, every: float = _LOOK_EVERY) -> int:
    """Run the command as a child, end it once the parent is gone, and return its exit code.

    Args:
        command: what to run.
        parent: process id of this process's parent.
        every: seconds between looks at it.
    """
    process = subprocess.Popen(list(command))  # noqa: S603 - our caller's own command
    while True:
        try:
            return process.wait(timeout=every)
        except subprocess.TimeoutExpired:
            if os.getppid() != parent:
                process.kill()
                return process.wait()


if __name__ == "__main__":
    _parent, _command = int(sys.argv[1]), sys.argv[2:]
    if sys.platform.startswith("linux"):
        become(_command, _parent)
    sys.exit(watch_over(_command, _parent))
