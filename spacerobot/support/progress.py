"""Progress with the time left, on standard error; silent where nobody watches."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import Self

from tqdm import tqdm


class _Bar(tqdm):
    """Without the thread that looks after bars that stand still: a process with threads cannot be copied safely."""

    monitor_interval = 0


class Progress:
    """A count that moves towards `total`. A context manager.

    Shown while standard error is a terminal; elsewhere only with `verbose`, as a line every five seconds.
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

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.close()

    def advance(self, steps: int = 1, note: str = "") -> None:
        """Count `steps` more; `note` says what was done."""
        if note:
            self._bar.set_postfix_str(note, refresh=False)
        self._bar.update(steps)

    def add(self, steps: int) -> None:
        """Expect `steps` more than was thought."""
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
