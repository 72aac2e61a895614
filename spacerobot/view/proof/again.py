"""What went wrong in a batch, played again with other code, as Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from spacerobot.proof.rates import Record
from spacerobot.proof.summary import missed, right
from spacerobot.view.proof.cells import favoured_in, hidden_in, strength_of, table

_INTRODUCTION = """\
# Proof: what went wrong, again

This page is written by `spacerobot prove --again`: the campaigns of a batch whose answer was wrong, made anew from the
same seeds and diagnosed by today's code. It shows what has been mended. It proves nothing of campaigns that nobody has
seen: these were looked at while the code was mended, and what was right before is not played again.
"""


def page(before: Sequence[Record], now: Sequence[Record], about: Mapping[str, Any]) -> str:
    """The page.

    Args:
        before: the batch's records.
        now: new records of the campaigns that went wrong in it, as many as have been played.
        about: batch (its seeds, with dates), codes then and now.
    """
    old = {r["name"]: r for r in before}
    wrong = missed(before)
    mended = sum(right(r) for r in now)
    head = ["campaign", "hidden", "strength", "said then", "says now", "favourite, or values moved", "right now"]
    rows = [
        [
            r["name"],
            hidden_in(r),
            strength_of(r),
            old[r["name"]]["said"],
            r["said"],
            favoured_in(r),
            "yes" if right(r) else "no",
        ]
        for r in sorted(now, key=lambda r: (right(r), r["name"]))
    ]
    part = "" if len(now) == len(wrong) else f" {len(now)} of them have been played so far."
    said = (
        f"{len(wrong)} campaigns went wrong in the batch of seed {about['seeds']}, code {about['then']}: a claim that "
        f"was false, or an effect of three detection limits or more that was not in the set given.{part} Of {len(now)} "
        f"**{mended}** are right with code {about['now']}."
    )
    return f"{_INTRODUCTION}\n{said}\n\n{table(head, rows)}"
