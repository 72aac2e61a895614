"""Cells and tables of the proof bench's pages."""

from __future__ import annotations

from collections.abc import Sequence

from spacerobot.proof.rates import Record


def hidden_in(record: Record) -> str:
    """What was hidden in a campaign, in words."""
    return " + ".join(" at ".join(h) for h in record["hidden"]) or ", ".join(record["wrong_values"]) or "nothing"


def favoured_in(record: Record) -> str:
    """What a diagnosis held likeliest: effects, else the values it moved."""
    return " + ".join(" at ".join(f) for f in record["favourite"]) or ", ".join(record["moved"]) or "-"


def strength_of(record: Record) -> str:
    """Strength of what was hidden, in detection limits."""
    return "-" if record["strength"] is None else f"{record['strength']:.1f}"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"
