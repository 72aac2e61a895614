"""Units of believed values by their names."""

from __future__ import annotations

from spacerobot.recordings.channel import dimensions
from spacerobot.recordings.units import SI
from spacerobot.recordings.values import kind
from spacerobot.support.errors import InputError


def unit_of_value(name: str) -> str:
    """Unit of a believed value, or of a channel's zero, by its dotted name; none for one that nobody knows."""
    try:
        if name.endswith(".zero") and not name.startswith("joint."):
            return SI[dimensions(name.removesuffix(".zero"))[0]]
        return kind(name).unit
    except InputError:
        return ""
