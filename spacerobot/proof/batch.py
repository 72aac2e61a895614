"""A batch of campaigns, side by side, resumed where it was stopped."""

from __future__ import annotations

import math
import os
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from spacerobot.proof.blind import COMMAND
from spacerobot.proof.driven.orders import FAMILY
from spacerobot.proof.driven.play import play_arm
from spacerobot.proof.orders import Order
from spacerobot.proof.record import play
from spacerobot.support.executors.base import Executor, Here
from spacerobot.support.progress import Progress
from spacerobot.support.runs import RunFolder
from spacerobot.support.scratch import scratch

RIVALS_EVERY = 10
"""Rivals are tried on every so many of the rig's campaigns of these kinds, since they take their time."""

RIVALS_ON = ("nothing_missing", "wrong_value", "unlabelled", "masked", "two", "outsider")

RATE = {
    "nothing_missing": "nothing",
    "wrong_value": "value",
    "outsider": "outside",
    "withheld": "outside",
    "power": "power",
    "spoiled": "spoiled",
    "relative": "spoiled",
    "law": "learned",
}
"""Kind of concealment -> rate that it counts in; all others have an effect to be named."""

FIRST = {"nothing": 205, "value": 205, "outside": 226, "named": 170, "spoiled": 160, "learned": 120}
"""Rate -> campaigns with which it has its 200: some outside the catalogue are set apart, an effect that is named has
more than one parameter, and the power curves name effects too. The power curves come before those beyond.
"""


def rate_of(order: Order) -> str:
    """The rate that an order counts in."""
    return RATE.get(order.kind, "named")


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
    seconds: float = math.inf,
) -> list[dict[str, Any]]:
    """Play every order that has no record yet; each record is kept as soon as it is there.

    They are played as `in_turn` has them: a batch that ends early is a sample of the whole.

    Args:
        folder: keeps the records, one file each.
        orders: the batch.
        workers: that play them; this process alone if None.
        rivals: whether rivals are tried where the batch foresees it.
        verbose: show progress although nobody watches.
        command: the diagnosis.
        seconds: after which no further campaign begins.
    """
    until = time.monotonic() + seconds
    records = {o.name: folder.load(o.name) for o in orders}
    waiting = [o for o in in_turn(orders) if records[o.name] is None]
    with Progress("proving", len(orders), unit="campaign", verbose=verbose) as progress:
        progress.advance(len(orders) - len(waiting))
        tasks = (Play(o, rivals and with_rivals(o), tuple(command)) for o in _while_time(waiting, until))
        for _, record in (workers or Here()).run(played, tasks):
            folder.save(record["name"], record)
            records[record["name"]] = record
            progress.advance(note=f"{record['name']}: {record.get('said', 'not made')}")
    return [found for o in orders if (found := records[o.name]) is not None]


def in_turn(orders: Sequence[Order]) -> list[Order]:
    """The kinds that make up a rate in turn, so that all rates fill alike, then the power curves, then the others.

    Within a rate they come in the order of their seeds, which is a random one.
    """
    drawn = sorted(orders, key=lambda o: (o.seed, o.name))
    place: dict[Order, tuple[bool, bool, int]] = {}
    counts = Counter[str]()
    for order in drawn:
        rate = rate_of(order)
        beyond = rate != "power" and counts[rate] >= FIRST[rate]
        place[order] = (beyond, rate == "power", counts[rate])
        counts[rate] += 1
    return sorted(drawn, key=place.__getitem__)  # a stable sort: of one place, in the order drawn


def _while_time(orders: Sequence[Order], until: float) -> Iterator[Order]:
    for order in orders:
        if time.monotonic() >= until:
            return
        yield order


@dataclass(frozen=True)
class Play:
    """One task: an order, and how it is played."""

    order: Order
    rivals: bool
    command: tuple[str, ...]


def played(task: Play) -> dict[str, Any]:
    """In a worker: the record of an order."""
    with scratch("proof") as folder:
        if task.order.family == FAMILY:
            return play_arm(task.order, folder, command=task.command)
        return play(task.order, folder, rivals=task.rivals, command=task.command)
