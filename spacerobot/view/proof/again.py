"""What went wrong in a batch, played again with other code, as Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from spacerobot.proof.rates import Record
from spacerobot.proof.summary import missed, right

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
            " + ".join(" at ".join(h) for h in r["hidden"]) or ", ".join(r["wrong_values"]) or "nothing",
            "-" if r["strength"] is None else f"{r['strength']:.1f}",
            old[r["name"]]["said"],
            r["said"],
            " + ".join(" at ".join(f) for f in r["favourite"]) or ", ".join(r["moved"]) or "-",
            "yes" if right(r) else "no",
        ]
        for r in sorted(now, key=lambda r: (right(r), r["name"]))
    ]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(r) + " |" for r in rows)]
    part = "" if len(now) == len(wrong) else f" {len(now)} of them have been played so far."
    said = (
        f"{len(wrong)} campaigns went wrong in the batch of seed {about['seeds']}, code {about['then']}: a claim that "
        f"was false, or an effect of three detection limits or more that was not in the set given.{part} Of {len(now)} "
        f"**{mended}** are right with code {about['now']}."
    )
    return f"{_INTRODUCTION}\n{said}\n\n" + "\n".join(lines) + "\n"
