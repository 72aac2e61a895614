"""Worker processes of this machine; one that dies is replaced, and its task run again."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool

from spacerobot.support.executors.base import Executor, R, T, WorkersLostError
from spacerobot.support.workers import begin, context

MOST_DEATHS = 3
"""Deaths in a row, without a task done between them, after which it is given up."""


class LocalPool(Executor):
    """Processes of this machine.

    Args:
        jobs: how many.
    """

    def __init__(self, jobs: int) -> None:
        self.workers = jobs
        self._pool: ProcessPoolExecutor | None = None

    def run(self, function: Callable[[T], R], tasks: Iterable[T]) -> Iterator[tuple[T, R]]:
        """See `Executor.run`."""
        waiting = iter(tasks)
        again: list[T] = []
        running: dict[Future[R], T] = {}
        deaths, more = 0, True
        while True:
            while len(running) < self.workers and (again or more):
                if again:
                    task = again.pop()
                else:
                    try:
                        task = next(waiting)
                    except StopIteration:
                        more = False
                        break
                try:
                    running[self._opened().submit(function, task)] = task
                except BrokenProcessPool:  # found out before a result told us
                    again.append(task)
                    if not running:
                        self._drop()
                    break
            if not running and not again:
                return
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            broken = False
            for future in done:
                task = running.pop(future)
                try:
                    result = future.result()
                except BrokenProcessPool:
                    again.append(task)
                    broken = True
                    continue
                deaths = 0
                yield task, result
            if broken:
                deaths += 1
                if deaths > MOST_DEATHS:
                    raise WorkersLostError(f"worker processes died {deaths} times in a row (out of memory, or killed)")
                again += running.values()  # the pool is gone with all its tasks
                running.clear()
                self._drop()

    def close(self) -> None:
        """See `Executor.close`."""
        if self._pool is not None:
            processes = list((getattr(self._pool, "_processes", None) or {}).values())
            self._pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:  # their files are whole or not there, so nothing is lost by it
                process.terminate()
            self._drop()

    def _opened(self) -> ProcessPoolExecutor:
        if self._pool is None:
            self._pool = ProcessPoolExecutor(self.workers, mp_context=context(fork=False), initializer=begin)
        return self._pool

    def _drop(self) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)
            self._pool = None
