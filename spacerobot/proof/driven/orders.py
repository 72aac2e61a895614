"""What the arm's share of a batch consists of."""

from __future__ import annotations

import hashlib

from spacerobot.proof.orders import Order

FAMILY = "driven arm"

FULL = {"nothing_missing": 18, "wrong_value": 18, "unlabelled": 32, "two": 12, "outsider": 20}
"""Kind -> campaigns."""

QUICK = {"unlabelled": 1}
"""The same of a quick batch."""


def schedule(counts: dict[str, int], seed: int) -> list[Order]:
    """All orders, each with its own seed drawn from `seed`; more of a kind contain fewer."""
    return [
        Order(kind, FAMILY, number, seed=_seed(f"{seed} {kind} {number}"))
        for kind, count in counts.items()
        for number in range(count)
    ]


def _seed(text: str) -> int:
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")
