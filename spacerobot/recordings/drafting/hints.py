"""Columns of which nothing is known, each with what it does and the channels that it could be."""

from __future__ import annotations

from collections.abc import MutableSet, Sequence

import numpy as np

from spacerobot.recordings.drafting.columns import Reading
from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.groups import unused
from spacerobot.recordings.drafting.lines import Line
from spacerobot.recordings.drafting.shapes import in_steps, is_smooth, turn_of
from spacerobot.recordings.table import Floats

MOST = 128
"""Columns that are listed; further ones are left out."""

LATEST = 8
"""Rows by which a copy of a column may come later: a controller keeps its last few readings beside."""

LARGE = 10.0
"""Readings beyond this are more metres than a laboratory has, and more radians than a joint turns."""

_COULD_BE = {
    "wrist": {"smooth": "target.x or wrist.x", "rough": "contact.force", "steps": "a status"},
    "arm": {
        "smooth": "joint.NAME.position", "rough": "joint.NAME.torque or .velocity", "steps": "joint.NAME.reference",
    },
    "platform": {
        "smooth": "base.position.x, .y, base.yaw or joint.NAME.position", "rough": "joint.NAME.velocity or .torque",
        "steps": 'base.force.x, .y or base.torque.yaw with use = "input"',
    },
    "body": {
        "smooth": "body.position.x, .y or body.yaw", "rough": "body.velocity.x, .y or body.velocity.yaw",
        "steps": 'body.force.x, .y or body.torque.yaw with use = "input"',
    },
    "axis": {
        "smooth": "joint.axis.position", "rough": 'joint.axis.velocity, or .torque or .voltage with use = "input"',
        "steps": 'joint.axis.torque or .voltage with use = "input"',
    },
    "": {
        "smooth": "target.x, body.position.x or joint.axis.position",
        "rough": "contact.force, body.velocity.x or joint.axis.torque",
        "steps": 'a status, or body.force.x with use = "input"',
    },
}  # fmt: skip
"""Kind of rig -> what a column does -> channels that do so."""

_TURNS = {
    "arm": "joint.NAME.position", "axis": "joint.axis.position", "pendulum": "joint.axis.position",
    "platform": "base.yaw", "wrist": "target.yaw",
}  # fmt: skip
"""Kind of rig -> what jumps by a turn; else body.yaw."""


def loose(found: Sequence[Reading], file: Found, kind: str, taken: MutableSet[str]) -> list[Line]:
    """Columns that could not be told, kept under names of their own; those that never change are left out.

    Args:
        found: the columns.
        file: that they are of.
        kind: of rig, "" where that is not known either.
        taken: names of channels, to which theirs are added.
    """
    lines: list[Line] = []
    listed: dict[str, Floats] = {}
    for reading in found:
        values = file.table.columns[reading.index].values
        seen = values[np.isfinite(values)]
        if len(lines) == MOST or not len(seen) or not np.ptp(seen) > 0.0:
            continue
        plain = reading.plain.channel
        channel = unused(plain if plain.startswith("aux.") else f"aux.{reading.index}", taken)
        taken.add(channel)
        again = next((said for name, other in listed.items() if (said := _again(values, name, other))), "")
        lines.append(Line(reading, channel, remark=again or hint(seen, kind)))
        if not again:
            listed[reading.column] = values
    return lines


def _again(values: Floats, name: str, other: Floats) -> str:
    """How a column repeats another; "" where it does not."""
    for later in range(LATEST + 1 if len(values) == len(other) > 2 * LATEST else 0):
        mine, theirs = values[later:], other[: len(other) - later]
        same = (mine == theirs) | (np.isnan(mine) & np.isnan(theirs))
        if same.all():
            rows = "row" if later == 1 else "rows"
            return f"as {name}, {later} {rows} later" if later else f"as {name}"
    return ""


def hint(values: Floats, kind: str) -> str:
    """What a column does, and which channels of a kind of rig it could be.

    Args:
        values: (n,) finite readings that are not all the same, in order.
        kind: of rig.
    """
    low, high = float(values.min()), float(values.max())
    span = f"{low:.4g} to {high:.4g}"
    if turn := turn_of(values):
        unit = ', unit = "deg"' if turn == "deg" else ""
        return f"{span}, jumps by a turn: {_TURNS.get(kind, 'body.yaw')}{unit}, unwrap = true?"
    could_be = _COULD_BE.get(kind, _COULD_BE["axis"])
    if in_steps(values):
        return f"{span} in steps: {could_be['steps']}?"
    if is_smooth(values):
        unit = "in mm or deg" if max(abs(low), abs(high)) > LARGE else "in m or rad"
        return f"{span}, smooth: {could_be['smooth']}, {unit}?"
    return f"{span}, rough: {could_be['rough']}?"
