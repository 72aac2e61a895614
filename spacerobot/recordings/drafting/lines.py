"""The lines of a draft: a channel each, with its unit, sign, zero and noise."""

from __future__ import annotations

import json
from dataclasses import dataclass, field

from spacerobot.recordings.channel import dimensions
from spacerobot.recordings.drafting.columns import Reading
from spacerobot.recordings.units import UNITS
from spacerobot.simulation.parts.checks import LARGEST, SMALLEST

LARGEST_RIG = 10.0
"""Further than a body drifts on any table [m]."""


@dataclass
class Line:
    """A column that becomes a channel.

    Attributes:
        reading: the column.
        channel: canonical name.
        scale: factor on the reading: -1 turns it round.
        plus: other columns with their factors, added to it.
        offset: added after the factors, in the reading's unit.
        offset_sigma: how well that is known, one standard deviation; 0 where no better than needed.
        sigma: noise in the reading's unit, None where it was not seen.
        use: "output" or "input".
        unwrap: whether an angle jumps by turns.
        lost: whether exactly 0 is no reading.
        moment: "before" or "after" an event; "" for a sample.
        remark: for the reader of the draft.
        question: what its author must answer.
    """

    reading: Reading
    channel: str
    scale: float = 1.0
    plus: dict[str, float] = field(default_factory=dict)
    offset: float = 0.0
    offset_sigma: float = 0.0
    sigma: float | None = None
    use: str = "output"
    unwrap: bool = False
    lost: bool = False
    moment: str = ""
    remark: str = ""
    question: str = ""

    def text(self) -> str:
        """The line in TOML."""
        parts = [f"is = {toml(self.channel)}"]
        unit, factor = self.reading.unit, 1.0
        if unit is not None and UNITS[unit].dimension in dimensions(self.channel):
            factor = UNITS[unit].factor
        if factor != 1.0:
            parts.append(f"unit = {toml(str(unit))}")
        if self.scale != 1.0:
            parts.append(f"scale = {self.scale:.6g}")
        if self.plus:
            parts.append(f"plus = {{ {', '.join(f'{toml(c)} = {k:.6g}' for c, k in self.plus.items())} }}")
        if self.offset:
            parts.append(f"offset = {self.offset:.12g}")
        if self.offset and self.offset_sigma > 0.0:
            parts.append(f"offset_sigma = {self.offset_sigma:.1g}")
        if self.sigma is not None and SMALLEST <= self.sigma * factor <= LARGEST:  # below is rounding, and is refused
            parts.append(f"sigma = {self.sigma:.2g}")
        if self.use != "output":
            parts.append(f"use = {toml(self.use)}")
        if self.unwrap:
            parts.append("unwrap = true")
        if self.lost:
            parts.append("missing = 0.0")
        if self.moment:
            parts.append(f"moment = {toml(self.moment)}")
        tail = f"   # {comment(self.remark)}" if self.remark else ""
        asked = f"   # ? {comment(self.question)}" if self.question else tail
        return f"{toml(self.reading.column)} = {{ {', '.join(parts)} }}{asked}"


def toml(value: str) -> str:
    """A TOML string."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def comment(value: str) -> str:
    """`value` as it may stand in a comment."""
    return "".join(c if c.isprintable() else "?" for c in value)[:400]
