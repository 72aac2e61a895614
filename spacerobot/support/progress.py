"""Progress with the time left, on standard error; silent where nobody watches."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import time
from types import TracebackType
from typing import Any, Self

from tqdm import tqdm


class _Bar(tqdm):
    """Without the thread that looks after bars that stand still: a process with threads cannot be copied safely."""

    monitor_interval = 0


SILENT = 10.0
"""Seconds after which work that nobody watches says where it is, and again every so many."""

_compiling = 0
"""How many functions are being compiled right now, one within another."""


def compiling(more: int) -> None:
    """Say that so many more functions (fewer, where negative) are being compiled: what waits for it says so."""
    global _compiling
    _compiling = max(0, _compiling + more)


class _Heart:
    """Prints a line of the innermost work by the alarm clock of the process: no thread, which a fork would not copy.

    Where there is no such clock, in another thread than the main one, or where somebody else uses it, nothing is said.
    """

    def __init__(self) -> None:
        self._stack: list[Progress] = []
        self._before: Any = None
        self._owner = 0
        self._said = 0.0
        self._left = float("-inf")

    def join(self, work: Progress) -> None:
        """Begin to tell of some work."""
        if not self._stack:
            free = hasattr(signal, "SIGALRM") and threading.current_thread() is threading.main_thread()
            if not free or signal.getsignal(signal.SIGALRM) not in (signal.SIG_DFL, signal.SIG_IGN, self._tell):
                return
            self._before, self._owner = signal.getsignal(signal.SIGALRM), os.getpid()
            signal.signal(signal.SIGALRM, self._tell)
            if signal.getitimer(signal.ITIMER_REAL)[0] == 0.0:
                now = time.monotonic()
                if now - self._left > 1.0:  # not the next of several short stages
                    self._said = now
                signal.siginterrupt(signal.SIGALRM, False)
                signal.setitimer(signal.ITIMER_REAL, max(self._said + SILENT - now, 0.05), SILENT)
        self._stack.append(work)

    def leave(self, work: Progress) -> None:
        """Tell of it no more."""
        if work not in self._stack:
            return
        self._stack.remove(work)
        if not self._stack and self._owner == os.getpid():
            self._left = time.monotonic()
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, self._before)

    def _tell(self, *_: object) -> None:
        if self._stack and self._owner == os.getpid():
            self._said = time.monotonic()
            with contextlib.suppress(OSError, ValueError, RuntimeError):  # the alarm may ring within a print
                print(self._stack[-1].line(), file=sys.stderr, flush=True)


_heart = _Heart()


def plural(noun: str) -> str:
    """Several of a noun: trials, studies."""
    ends = noun[-1:] == "y" and noun[-2:-1] not in "aeiou"
    return f"{noun[:-1]}ies" if ends else f"{noun}s"


class Progress:
    """A count that moves towards `total`. A context manager.

    Shown while standard error is a terminal; with `verbose` elsewhere as a line every five seconds. Without it a line
    says every ten seconds where the work is, so that a log or a pipe is never silent for long; short work says nothing.
    Standard output is never touched, so that `--json` stays one object.

    Args:
        what: what is being done, e.g. "fitting pairs".
        total: number of steps, None if unknown.
        unit: what one step is.
        verbose: show it although nobody watches.
        quiet: never show it.
    """

    def __init__(
        self,
        what: str,
        total: int | None = None,
        *,
        unit: str = "step",
        verbose: bool = False,
        quiet: bool = False,
    ) -> None:
        watched = sys.stderr.isatty()
        self._bar = _Bar(
            desc=what,
            total=total,
            unit=f" {unit}",
            file=sys.stderr,
            disable=quiet or not (watched or verbose),
            mininterval=0.2 if watched else 5.0,
            miniters=1,
            leave=False if watched else None,
            dynamic_ncols=watched,
        )
        self._what, self._total, self._unit, self._count = what, total, unit, 0
        self._begun = time.monotonic()
        self._piped = not (quiet or watched or verbose)

    def __enter__(self) -> Self:
        if self._piped:
            _heart.join(self)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        _heart.leave(self)
        self._bar.close()

    def line(self) -> str:
        """Where the work is, in a line."""
        of = "" if self._total is None else f" of {self._total}"
        waits = " (compiling, once after an installation)" if _compiling else ""
        count = f": {self._count}{of} {plural(self._unit)}" if self._count or of else ""
        return f"{self._what}{count}, {time.monotonic() - self._begun:.0f} s{waits}"

    def call(self, what: str) -> None:
        """Say from now on that this is being done."""
        if what != self._what:
            self._what = what
            self._bar.set_description_str(what, refresh=False)

    def advance(self, steps: int = 1, note: str = "") -> None:
        """Count `steps` more; `note` says what was done."""
        if note:
            self._bar.set_postfix_str(note, refresh=False)
        self._bar.update(steps)
        self._count += steps

    def add(self, steps: int) -> None:
        """Expect `steps` more than was thought."""
        self._total = None if self._total is None else self._total + steps
        if self._bar.total is not None:
            self._bar.total += steps
            self._bar.refresh()

    @property
    def done(self) -> int:
        """Steps counted so far; 0 where nothing is shown."""
        return int(self._bar.n)


def say(text: str, *, verbose: bool = True) -> None:
    """A line on standard error, if `verbose`."""
    if verbose:
        tqdm.write(text, file=sys.stderr)
