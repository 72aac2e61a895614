"""What worker processes of this machine have in common: how they begin, and who answers Ctrl-C."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from multiprocessing.context import ForkContext, SpawnContext

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Set to 1 in workers: sums of linear algebra then do not depend on how many cores a machine has."""


def begin(*_: object) -> None:
    """First thing in a worker: an interrupt is the parent's to answer, and one thread of linear algebra is enough."""
    from spacerobot.support.orphans import end_with_parent

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    for name in THREAD_VARIABLES:
        os.environ[name] = "1"


@contextlib.contextmanager
def one_thread() -> Iterator[None]:
    """While it is open, or in what it decorates: linear algebra on one thread, as in workers."""
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="blas"):
        yield


def may_fork() -> bool:
    """Whether processes may begin as copies of this one, which load and compile nothing: not beside other threads."""
    return sys.platform == "linux" and threading.active_count() == 1


def context(fork: bool) -> ForkContext | SpawnContext:
    """Of processes that begin as copies of this one, or afresh."""
    import multiprocessing  # every command loads this file, and few begin processes

    return multiprocessing.get_context("fork") if fork else multiprocessing.get_context("spawn")


@contextlib.contextmanager
def without_interrupts() -> Iterator[None]:
    """Hold back Ctrl-C: it is this process's to answer, and a worker that has just begun would answer it too."""
    held = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, held)
