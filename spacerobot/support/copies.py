"""Work side by side in copies of this process, each of which holds the same things."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import CancelledError, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from spacerobot.support.workers import begin, context, may_fork, without_interrupts

H = TypeVar("H")
R = TypeVar("R")

_held: Any = None


def _hold(make: Callable[[], Any]) -> None:
    global _held
    begin()
    _held = make()


def _ready() -> None:
    """What a process does first."""


def _do(work: Callable[..., R], arguments: tuple[Any, ...]) -> R:
    return work(_held, *arguments)


@dataclass(frozen=True)
class Waiting(Generic[R]):
    """What is under way: called, it gives its result."""

    result: Callable[[], R]
    future: Future[R] | None = None

    def __call__(self) -> R:
        """Wait for it."""
        return self.result()

    def cancel(self) -> None:
        """Nobody wants it; it is not begun any more, if it was not yet."""
        if self.future is not None:
            self.future.cancel()


class Copies(Generic[H]):
    """Processes that hold the same things, closed on exit; none where one job is allowed.

    Where one is lost (killed for want of memory, most often) the rest is done in the calling process.

    Args:
        held: what the calling process holds.
        jobs: processes.
        make: what each makes for itself; picklable where processes cannot be copied.
        load: compiles code, once for all copies of this process.
    """

    def __init__(
        self, held: H, jobs: int, make: Callable[[], H], load: Callable[[H], None] = lambda held: None
    ) -> None:
        self.held = held
        self._executor: ProcessPoolExecutor | None = None
        if jobs < 2:
            return
        fork = may_fork()
        if fork:
            load(held)
        self._executor = ProcessPoolExecutor(jobs, mp_context=context(fork), initializer=_hold, initargs=(make,))
        with without_interrupts():  # begins the processes, before there are threads
            self._executor.submit(_ready)

    def __enter__(self) -> Copies[H]:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        self.close(now=kind is not None)

    def close(self, *, now: bool) -> None:
        """End them; `now`, whatever they are at."""
        if self._executor is None:
            return
        processes = list((getattr(self._executor, "_processes", None) or {}).values())
        self._executor.shutdown(wait=not now, cancel_futures=True)
        if now:
            for process in processes:  # nobody waits for what they are at
                process.terminate()
        self._executor = None

    def aside(self, work: Callable[..., R], *arguments: Any) -> Waiting[R]:
        """work(held, *arguments) in another process; where there is none or it is lost, in this one when asked for.

        Args:
            work: importable by name; changes nothing.
            arguments: picklable, as the result is.
        """

        def here() -> R:
            return work(self.held, *arguments)

        if self._executor is None:
            return Waiting(here)
        try:
            with without_interrupts():  # submitting begins processes, and they take over what is blocked
                future = self._executor.submit(_do, work, arguments)
        except BrokenProcessPool:
            self.close(now=True)
            return Waiting(here)

        def result() -> R:
            try:
                return future.result()
            except (BrokenProcessPool, CancelledError):
                self.close(now=True)
                return here()

        return Waiting(result, future)

    def each(self, work: Callable[..., R], arguments: Iterable[tuple[Any, ...]]) -> list[Waiting[R]]:
        """The same for all arguments, in their order."""
        return [self.aside(work, *some) for some in arguments]
