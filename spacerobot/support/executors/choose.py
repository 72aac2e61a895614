"""Which executor a command's options ask for."""

from __future__ import annotations

from spacerobot.support.errors import InputError
from spacerobot.support.executors.base import Executor, Here
from spacerobot.support.executors.local import LocalPool


def not_both(jobs: object, dask: str | None) -> None:
    """Refuse a number of processes beside a scheduler, whose workers are its own.

    Raises:
        InputError: both are given.
    """
    if dask is not None and jobs is not None:
        raise InputError("the workers are Dask's", given=f"--jobs {jobs}", valid="--dask or --jobs")


def executor(jobs: int = 1, dask: str | None = None) -> Executor:
    """The workers of a Dask scheduler if one is named, else `jobs` processes, or this one alone.

    Raises:
        InputError: the scheduler cannot be used.
    """
    if dask is not None:
        from spacerobot.support.executors.cluster import DaskWorkers

        return DaskWorkers(dask)
    return LocalPool(jobs) if jobs > 1 else Here()
