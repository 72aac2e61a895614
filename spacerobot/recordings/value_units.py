"""Units of believed values by their names."""

from __future__ import annotations

from spacerobot.recordings.channel import dimensions
from spacerobot.recordings.units import SI
from spacerobot.recordings.values import kind
from spacerobot.support.errors import InputError


def unit_of_channel(name: str) -> str:
    """SI unit of a channel; none of one that may turn or slide, or that nobody knows."""
    try:
        measured = dimensions(name.removesuffix(".before").removesuffix(".after"))
    except InputError:
        return ""
    return SI[measured[0]] if len(measured) == 1 else ""


def unit_of_value(name: str) -> str:
    """Unit of a believed value, or of a channel's zero, by its dotted name; none for one that nobody knows."""
    try:
        if name.endswith(".zero") and not name.startswith("joint."):
            return unit_of_channel(name.removesuffix(".zero"))
        return kind(name).unit
    except InputError:
        return ""
