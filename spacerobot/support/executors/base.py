"""What every executor does."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from types import TracebackType
from typing import Self, TypeVar

from spacerobot.support.errors import SpacerobotError

T = TypeVar("T")
R = TypeVar("R")


class WorkersLostError(SpacerobotError):
    """Workers that die again and again over the same tasks."""


class Executor(ABC):
    """Runs tasks and yields each result once. A context manager; leaving it gives up what is not done.

    Implementations must take tasks from the iterable only as there is room for them, so that a long campaign needs
    no more memory than a short one; and must run the tasks of a worker that died again elsewhere.
    """

    workers: int
    """Tasks that run at the same time."""

    @abstractmethod
    def run(self, function: Callable[[T], R], tasks: Iterable[T]) -> Iterator[tuple[T, R]]:
        """(task, function(task)) of every task, as they come; an exception of a task is raised here.

        Args:
            function: importable by name in another process.
            tasks: picklable; taken one by one.
        """

    def begin(self, function: Callable[[T], R], task: T) -> Callable[[], R]:
        """Begin one task; what comes back waits for its result. Here it begins no sooner than that is called."""
        return lambda: next(iter(self.run(function, [task])))[1]

    @abstractmethod
    def close(self) -> None:
        """Give up what is not done."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class Here(Executor):
    """One task after the other, in the calling process."""

    workers = 1

    def run(self, function: Callable[[T], R], tasks: Iterable[T]) -> Iterator[tuple[T, R]]:
        """See `Executor.run`."""
        for task in tasks:
            yield task, function(task)

    def close(self) -> None:
        """Nothing to give up."""
