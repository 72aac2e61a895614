"""A batch of campaigns, side by side, resumed where it was stopped."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from spacerobot.proof.blind import COMMAND
from spacerobot.proof.orders import Order
from spacerobot.proof.record import play
from spacerobot.support.executors.base import Executor, Here
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
    workers: Executor | None = None,
    rivals: bool = True,
    verbose: bool = False,
    command: Sequence[str] = COMMAND,
) -> list[dict[str, Any]]:
    """Play every order that has no record yet; each record is kept as soon as it is there.

    Args:
        folder: keeps the records, one file each.
        orders: the batch.
        workers: that play them; this process alone if None.
        rivals: whether rivals are tried where the batch foresees it.
        verbose: show progress although nobody watches.
        command: the diagnosis.
    """
    records = {o.name: folder.load(o.name) for o in orders}
    waiting = [o for o in orders if records[o.name] is None]
    with Progress("proving", len(orders), unit="campaign", verbose=verbose) as progress:
        progress.advance(len(orders) - len(waiting))
        tasks = (Play(o, rivals and with_rivals(o), tuple(command)) for o in waiting)
        for _, record in (workers or Here()).run(played, tasks):
            folder.save(record["name"], record)
            records[record["name"]] = record
            progress.advance(note=f"{record['name']}: {record.get('said', 'not made')}")
    return [found for o in orders if (found := records[o.name]) is not None]


@dataclass(frozen=True)
class Play:
    """One task: an order, and how it is played."""

    order: Order
    rivals: bool
    command: tuple[str, ...]


def played(task: Play) -> dict[str, Any]:
    """In a worker: the record of an order."""
    with TemporaryDirectory(prefix="proof-") as scratch:
        return play(task.order, Path(scratch), rivals=task.rivals, command=task.command)
