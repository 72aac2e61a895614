"""A batch of campaigns, side by side, resumed where it was stopped."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from spacerobot.proof.blind import COMMAND
from spacerobot.proof.orders import Order
from spacerobot.proof.record import play
from spacerobot.support.progress import Progress
from spacerobot.support.runs import RunFolder

RIVALS_EVERY = 4
"""Rivals are tried on every so many of the rig's campaigns of these kinds, since they take their time."""

RIVALS_ON = ("nothing_missing", "wrong_value", "unlabelled", "masked", "two", "outsider")


def draw_seed() -> int:
    """A seed from the operating system."""
    return int.from_bytes(os.urandom(6), "big")


def with_rivals(order: Order) -> bool:
    """Whether an order's files are given to the rivals too."""
    return order.kind in RIVALS_ON and order.family == "rig" and order.number % RIVALS_EVERY == 0


def run_batch(
    folder: RunFolder,
    orders: Sequence[Order],
    *,
    jobs: int = 1,
    rivals: bool = True,
    verbose: bool = False,
    command: Sequence[str] = COMMAND,
) -> list[dict[str, Any]]:
    """Play every order that has no record yet; each record is kept as soon as it is there.

    Args:
        folder: keeps the records, one file each.
        orders: the batch.
        jobs: campaigns at a time.
        rivals: whether rivals are tried where the batch foresees it.
        verbose: show progress although nobody watches.
        command: the diagnosis.
    """
    records = {o.name: folder.load(o.name) for o in orders}
    waiting = [o for o in orders if records[o.name] is None]
    with Progress("proving", len(orders), unit="campaign", verbose=verbose) as progress:
        progress.advance(len(orders) - len(waiting))
        for record in _played(waiting, jobs, rivals, command):
            folder.save(record["name"], record)
            records[record["name"]] = record
            progress.advance(note=f"{record['name']}: {record.get('said', 'not made')}")
    return [found for o in orders if (found := records[o.name]) is not None]


def _played(orders: Sequence[Order], jobs: int, rivals: bool, command: Sequence[str]) -> Iterator[dict[str, Any]]:
    with TemporaryDirectory(prefix="proof-") as scratch:
        if jobs == 1:
            for order in orders:
                yield play(order, Path(scratch), rivals=rivals and with_rivals(order), command=command)
            return
        context = multiprocessing.get_context("spawn")
        pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=_quiet)
        try:
            left = list(orders)
            running: set[Future[dict[str, Any]]] = set()
            while left or running:
                while left and len(running) < jobs:
                    order = left.pop(0)
                    running.add(
                        pool.submit(play, order, Path(scratch), rivals=rivals and with_rivals(order), command=command)
                    )
                done, running = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    yield future.result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _quiet() -> None:
    """In a worker: an interrupt is the parent's to answer; and one thread of linear algebra is enough."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
