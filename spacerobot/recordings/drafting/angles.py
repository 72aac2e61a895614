"""A body's angle of which nobody states a unit: degrees, and asked, where radians would be too many turns."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.lines import Line

FURTHEST = 4.0 * math.pi
"""Two turns [rad], beyond which `study check` too takes a joint's angle for one in degrees."""

LARGEST = 400.0
"""Degrees from -180 to 180 or 0 to 360, and some noise; what goes further is counted in something else."""

_ANGLE = re.compile(r"(?:target|wrist|hand|base|body)\.yaw")


def in_degrees(lines: Mapping[str, Sequence[Line]], files: Mapping[str, Found]) -> None:
    """A unit and a question at each angle without a unit that is too large for radians, or beside lengths in mm.

    Joints are asked for with their gears.

    Args:
        lines: stream -> its channels.
        files: stream -> one of its files.
    """
    for stream, found in lines.items():
        lengths = any("are they mm" in line.question for line in found)
        for line in found:
            if line.reading.unit is not None or not _ANGLE.fullmatch(line.channel):
                continue
            furthest = float(np.nanmax(np.abs(files[stream].table.columns[line.reading.index].values)))
            if not (FURTHEST < furthest <= LARGEST or lengths):
                continue
            line.reading = replace(line.reading, unit="deg")
            asked = f"no unit is stated, and readings reach {furthest:.3g}: are they deg"
            line.question = "; ".join(filter(None, (line.question, asked)))
