"""Whether an arm's logs are of motors: currents in place of torques, angles beyond what any joint turns."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.lines import Line, toml
from spacerobot.recordings.units import UNITS

FURTHEST = 4.0 * math.pi
"""What no arm's joint turns from end to end [rad]: wrists of industrial arms reach two turns."""


def gearing(lines: Mapping[str, Sequence[Line]], files: Mapping[str, Found]) -> list[str]:
    """The `[gears]` of a draft, empty where the logs are of joints; questions of currents are asked there, once.

    Args:
        lines: stream -> its channels.
        files: stream -> one of its files.
    """
    logged = {line.channel for found in lines.values() for line in found}
    currents = {stream: [x for x in found if x.channel.endswith(".current")] for stream, found in lines.items()}
    if any(c.endswith(".torque") for c in logged):
        currents = {}
    turned = {stream: _furthest(found, files[stream]) for stream, found in lines.items()}
    furthest = max(turned.values(), default=0.0)
    motors = [s for s in lines if currents.get(s) or (furthest > FURTHEST and _moves(lines[s]))]
    joints = list(
        dict.fromkeys(x.channel.split(".")[1] for s in motors for x in lines[s] if x.channel.startswith("joint."))
    )
    if not motors or not joints:
        return []
    for line in (x for found in currents.values() for x in found):
        line.question = ""
    far = f"   # ? a joint turns by {furthest:.3g} rad: is that deg, or how often does a motor turn for a joint's turn"
    rows = f"{far} (rows where they are coupled)" if furthest > FURTHEST else "   # motors' turns per joint's"
    text = ["[gears]", f"streams = [{', '.join(map(toml, motors))}]", f"joints = [{', '.join(map(toml, joints))}]"]
    text.append(f"ratio = [{', '.join(['1'] * len(joints))}]{rows}")
    if any(currents.values()):
        text.append("torque_per_ampere = 1.0   # ? N m/A of each motor (a list where they differ)")
    return text


def _moves(found: Sequence[Line]) -> bool:
    return any(x.channel.endswith((".position", ".velocity")) for x in found)


def _furthest(found: Sequence[Line], file: Found) -> float:
    """The longest way that a joint's position covers, rad where it turns."""
    spans = [0.0]
    for line in found:
        unit = UNITS[line.reading.unit or "rad"]
        if line.channel.startswith("joint.") and line.channel.endswith(".position") and unit.dimension == "angle":
            spans.append(unit.factor * float(np.nanmax(v) - np.nanmin(v)) if len(v := _values(line, file)) else 0.0)
    return max(spans)


def _values(line: Line, file: Found) -> np.ndarray:
    values = file.table.columns[line.reading.index].values
    return values[np.isfinite(values)]
