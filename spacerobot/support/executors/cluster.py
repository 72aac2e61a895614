"""The workers of a running Dask scheduler."""

from __future__ import annotations

import importlib.util
import os
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from spacerobot import __version__
from spacerobot.support.errors import InputError
from spacerobot.support.executors.base import Executor, R, T, WorkersLostError
from spacerobot.support.sources import package_hash
from spacerobot.support.workers import THREAD_VARIABLES

PATIENCE = 10.0
"""How long [s] the scheduler may take to answer, and workers to come."""

AHEAD = 2
"""Tasks given out for every thread of the workers, so that none waits for the next."""


class DaskWorkers(Executor):
    """Tasks on a Dask cluster. A task whose worker dies is run again by the scheduler, up to its `allowed-failures`.

    Args:
        address: of the scheduler, such as tcp://127.0.0.1:8786.

    Raises:
        InputError: Dask is not installed, nobody answers, there are no workers, or they run another version.
    """

    def __init__(self, address: str) -> None:
        if importlib.util.find_spec("distributed") is None:
            raise InputError("Dask is not installed", valid='pip install "spacerobot[scale]"', where="--dask")
        from distributed import Client

        try:
            self._client = Client(address, timeout=PATIENCE, set_as_default=False)
        except (OSError, TimeoutError, ValueError, TypeError) as error:
            raise InputError(
                f"no Dask scheduler answers ({type(error).__name__})",
                given=address,
                valid="the address that `dask scheduler` prints, such as tcp://127.0.0.1:8786",
                where="--dask",
            ) from None
        self._futures: dict[Any, Any] = {}
        try:
            self.workers = self._threads(address)
            self._same_version()
        except BaseException:
            self.close()
            raise

    def run(self, function: Callable[[T], R], tasks: Iterable[T]) -> Iterator[tuple[T, R]]:
        """See `Executor.run`."""
        from distributed import as_completed

        waiting, coming = iter(tasks), as_completed(loop=self._client.loop)

        def give() -> bool:
            for task in waiting:
                future = self._client.submit(function, task, pure=False)
                self._futures[future] = task
                coming.add(future)
                return True
            return False

        for _ in range(AHEAD * self.workers):
            if not give():
                break
        for future in coming:
            task = self._futures.pop(future)
            result = _result(future)
            give()
            yield task, result

    def begin(self, function: Callable[[T], R], task: T) -> Callable[[], R]:
        """See `Executor.begin`; it begins at once."""
        future = self._client.submit(function, task, pure=False)
        self._futures[future] = task

        def wait() -> R:
            del self._futures[future]
            return _result(future)

        return wait

    def everywhere(self, function: Callable[..., R], *arguments: Any) -> dict[str, R]:
        """function(*arguments) once on every worker, by the worker's address."""
        return dict(self._client.run(function, *arguments))

    def close(self) -> None:
        """See `Executor.close`."""
        if self._futures:
            self._client.cancel(list(self._futures), force=True)
            self._futures.clear()
        self._client.close()

    def _threads(self, address: str) -> int:
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            threads = sum(self._client.nthreads().values())
            if threads:
                return int(threads)
            time.sleep(0.1)
        raise InputError(
            "the Dask scheduler has no workers", given=address, valid="start some: dask worker ADDRESS", where="--dask"
        )

    def _same_version(self) -> None:
        try:
            found = self.everywhere(version_here)
        except Exception as error:  # whatever the worker's import raised
            raise InputError(
                f"the Dask workers cannot load spacerobot ({type(error).__name__}: {error})", where="--dask"
            ) from None
        for worker, version in found.items():
            if version != version_here():
                raise InputError(
                    f"the Dask worker {worker} runs another spacerobot",
                    given=version,
                    valid=version_here(),
                    where="--dask",
                )


def _result(future: Any) -> Any:
    """What a worker made of a task; its memory there is released."""
    from distributed import CancelledError
    from distributed.scheduler import KilledWorker

    try:
        result = future.result()
    except KilledWorker as error:
        raise WorkersLostError(f"workers died again and again: {error}") from None
    except CancelledError:
        raise WorkersLostError("the Dask scheduler went away; what is done stays") from None
    future.release()
    return result


def version_here() -> str:
    """In a worker: its version and code; pins its linear algebra to one thread for whatever is loaded later."""
    for name in THREAD_VARIABLES:
        os.environ.setdefault(name, "1")
    return f"{__version__}, code {package_hash()}"
