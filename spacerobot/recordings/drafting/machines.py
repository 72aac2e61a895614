"""Machines without a wrist: arms with joint logs, platforms, free bodies, single axes, and what their columns are."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.recordings.drafting.columns import Reading
from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.heads import AXIS
from spacerobot.recordings.drafting.lines import LARGEST_RIG, Line
from spacerobot.recordings.drafting.pendulum import GRAVITY
from spacerobot.recordings.guess import time_unit
from spacerobot.recordings.series import estimate_noise
from spacerobot.recordings.table import Floats
from spacerobot.recordings.units import UNITS

AXIS_URDF = """<?xml version="1.0"?>
<!-- One driven axis, written by `study new`. Its mass comes from the study. -->
<robot name="axis">
  <link name="frame">
    <inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  </link>
  <link name="moving">
    <inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  </link>
  <joint name="axis" type="{kind}">
    <parent link="frame"/><child link="moving"/>
    <axis xyz="{direction}"/>
    <limit lower="-1000" upper="1000" effort="1e6" velocity="1e4"/>
  </joint>
</robot>
"""

FEWEST = 12
"""Readings of a fall, at least: a parabola has three numbers."""

_MEASURED = re.compile(r"current_|actual|meas", re.I)

_DRIVES = ("torque", "force", "voltage", "current")


def kind_of(readings: Mapping[str, Sequence[Reading]]) -> str:
    """ "arm", "platform", "axis", "body", or "" where nothing was recognised."""
    every = [r for found in readings.values() for r in found]
    measured = [r for r in every if not r.command]
    joints = {r.thing for r in measured if r.thing.startswith("joint:") and r.quantity}
    floats = any(r.thing == "base" and r.quantity == "position" for r in measured)
    if joints:
        return "platform" if floats else "arm"
    plane = {r.axis for r in measured if r.quantity == "position" and r.axis in ("x", "y", "z")}
    if plane:
        return "body"
    single = [r for r in measured if r.quantity in ("position", "velocity")]
    return "axis" if single else ""


def as_platform(readings: Mapping[str, Sequence[Reading]]) -> dict[str, list[Reading]]:
    """The readings of what is said to be a platform: where none is called so, it is the body that nothing names."""
    every = [r for found in readings.values() for r in found]
    if any(r.thing == "base" and r.quantity == "position" for r in every):
        return {stream: list(found) for stream, found in readings.items()}
    return {
        stream: [replace(r, thing="base") if r.thing == "" and r.axis and r.quantity else r for r in found]
        for stream, found in readings.items()
    }


def draft_machine(
    kind: str,
    readings: Mapping[str, Sequence[Reading]],
    files: Mapping[str, Found],
    *,
    driven: bool = True,
    joint: str = AXIS,
) -> dict[str, list[Line]]:
    """Stream -> its channels, for a machine of this kind.

    Args:
        kind: see `kind_of`.
        readings: stream -> what its columns seem to be.
        files: stream -> one of its files.
        driven: whether something drives an axis, so that a column of that is asked for.
        joint: what an axis is called.
    """
    main = _main_thing(readings) if kind == "body" else ""
    found: dict[str, list[Line]] = {}
    taken: set[str] = set()
    for stream, columns in readings.items():
        # Where two columns are one channel, the one that says it is measured goes first.
        measured = {r.column for r in columns if _MEASURED.search(r.column) and not r.command}
        for reading in sorted(columns, key=lambda r: r.column not in measured):
            line = _line(kind, reading, main, joint)
            if line is None or line.channel in taken:
                continue
            if measured and reading.column not in measured and kind == "body" and line.use == "output":
                continue
            taken.add(line.channel)
            values = files[stream].table.columns[reading.index].values
            if line.use == "output" and not line.channel.endswith(".reference"):
                # Not stated as sigma: a smooth log may have been filtered, and then its scatter is not its noise.
                noise = estimate_noise(values)
                line.remark = f"scatter about {noise:.2g} as read: sigma = ?" if noise > 0 else ""
            found.setdefault(stream, []).append(line)
    if kind == "body":
        if not any(x.channel == "body.position.z" for lines in found.values() for x in lines):  # in a plane
            aside = ("body.angular_velocity.x", "body.angular_velocity.y")
            found = {stream: [x for x in lines if x.channel not in aside] for stream, lines in found.items()}
        for stream, lines in found.items():
            _in_their_unit(lines, files[stream])
    if kind == "axis":
        _as_torque([line for lines in found.values() for line in lines], joint)
    if kind == "axis" and driven and found and not any(x.use == "input" for lines in found.values() for x in lines):
        first = next(iter(found.values()))[0]
        first.question = (
            f'which column drives the axis: joint.{joint}.torque or .voltage, with use = "input"; where nothing does, '
            f"joint.{joint}.torque = 0 above"
        )
    return {stream: sorted(lines, key=lambda x: x.reading.index) for stream, lines in found.items()}


def _in_their_unit(lines: Sequence[Line], file: Found) -> None:
    """Of a body's places that state none: as it falls; millimetres, and a question, if in metres it left any table."""
    places = [x for x in lines if re.fullmatch(r"(?:body|marker\..+)\.position\.[xyz]", x.channel)]
    places = [x for x in places if x.reading.unit is None]
    spans = {id(x): float(np.nanmax(v) - np.nanmin(v)) for x in places if len(v := _values(x, file))}
    if not spans or (unit := _unit_of_fall(places, file)) == "m":
        return
    if unit:
        for line in places:
            line.reading = replace(line.reading, unit=unit)
            line.remark = "; ".join(r for r in (line.remark, f"in {unit} it falls freely") if r)
        return
    if max(spans.values()) <= LARGEST_RIG:
        return
    for line in places:
        line.reading = replace(line.reading, unit="mm")
    furthest = max(places, key=lambda x: spans.get(id(x), 0.0))
    furthest.question = (
        f"no unit is stated, and readings span {max(spans.values()):.3g}: mm, cm, or pixels (then scale)"
    )


NEARLY = 0.2
"""Share of standard gravity within which a track falls freely: the air holds a ball back by less."""


def _unit_of_fall(places: Sequence[Line], file: Found) -> str:
    """In which unit of length the third place falls freely from the first reading to the last; empty where in none."""
    if file.clock is None:
        return ""
    time = file.table.columns[file.clock].values * UNITS[time_unit(file.called.columns[file.clock])].factor
    for line in places:
        value = file.table.columns[line.reading.index].values
        known = np.isfinite(value) & np.isfinite(time) if value.shape == time.shape else np.zeros(0, dtype=bool)
        if not line.channel.endswith(".z") or known.sum() < FEWEST:
            continue
        bend = 2.0 * np.polynomial.Polynomial.fit(time[known], value[known], 2).convert().coef[-1]
        for unit in ("m", "cm", "mm"):
            if abs(bend * UNITS[unit].factor / -GRAVITY - 1.0) < NEARLY:
                return unit
    return ""


def _values(line: Line, file: Found) -> Floats:
    values = file.table.columns[line.reading.index].values
    return values[np.isfinite(values)]


def _as_torque(lines: Sequence[Line], joint: str) -> None:
    """What drives an axis, where no torque is logged: its current or voltage, for which the baseline has a constant."""
    drives = [x for x in lines if x.channel in (f"joint.{joint}.current", f"joint.{joint}.voltage")]
    if len(drives) != 1 or any(x.channel == f"joint.{joint}.torque" for x in lines):
        return
    line, unit = drives[0], drives[0].reading.unit
    counted = "A" if line.channel.endswith("current") else "V"
    line.channel, line.scale = f"joint.{joint}.torque", UNITS[unit].factor if unit else 1.0
    line.reading = replace(line.reading, unit=None)
    line.question = f"in {counted}: state joint.{joint}.gain above, its N m (or N where it slides) for each"


def _main_thing(readings: Mapping[str, Sequence[Reading]]) -> str:
    """The body that most columns speak of."""
    things = [
        r.thing for found in readings.values() for r in found if r.quantity == "position" and r.axis and not r.command
    ]
    return max(dict.fromkeys(things), key=things.count) if things else ""


def _line(kind: str, reading: Reading, main: str, joint: str) -> Line | None:
    if reading.thing.startswith("joint:"):
        return _joint_line(reading, reading.thing.removeprefix("joint:"))
    if kind == "axis":
        return (
            _joint_line(reading, joint) if reading.thing == "" or reading.quantity in ("position", "velocity") else None
        )
    return _body_line(kind, reading, main)


def _joint_line(reading: Reading, joint: str) -> Line | None:
    quantity = "torque" if reading.quantity == "force" else reading.quantity
    if reading.command:
        if quantity in ("position", ""):
            return Line(reading, f"joint.{joint}.reference") if quantity else None
        if quantity not in _DRIVES:
            return None
    if quantity not in ("position", "velocity", "torque", "current", "voltage"):
        return None
    drives = quantity in _DRIVES
    line = Line(reading, f"joint.{joint}.{quantity}", use="input" if drives else "output")
    if reading.command and drives:
        line.remark = "as it was asked for, not measured"
    if quantity == "current":
        line.question = "a current: state what torque it is, as torque_per_ampere of [gears]"
    return line


def _body_line(kind: str, reading: Reading, main: str) -> Line | None:
    body = "base" if kind == "platform" else "body"
    if kind == "body" and reading.thing not in (main, ""):
        if reading.thing.startswith("body:") and reading.quantity == "position" and reading.axis in ("x", "y", "z"):
            return Line(reading, f"marker.{_in_ascii(reading.thing)}.position.{reading.axis}")
        return None
    quantity, axis = reading.quantity, reading.axis
    if kind in ("arm", "platform") and quantity == "force" and not reading.command and reading.thing in ("", "hand"):
        return Line(reading, f"hand.force.{axis}" if axis in ("x", "y", "z") else "contact.force")
    if kind == "platform" and reading.thing.startswith("body:") and quantity == "position" and axis in ("x", "y", "z"):
        return Line(reading, f"link.{_in_ascii(reading.thing)}.position.{axis}")
    if kind == "arm" or (kind == "platform" and reading.thing != "base"):
        return None
    if quantity == "torque" and axis == "z":
        axis = "yaw"  # about the table's normal, as every plane's machine calls it
    if quantity in ("force", "torque") and axis in ("x", "y", "z", "yaw"):
        if quantity == "force" and axis == "yaw":
            return None
        return Line(reading, f"{body}.{quantity}.{axis}", use="input")  # commanded or felt, it drives the body
    if kind == "body" and not axis and quantity == "position" and UNITS[reading.unit or "m"].dimension == "angle":
        axis = "yaw"  # in a plane there is one angle
    if reading.command or not axis:
        return None
    if quantity == "orientation" and axis in "wxyz":
        return Line(reading, f"{body}.orientation.{axis}")
    if quantity == "position":
        return Line(reading, f"{body}.yaw" if axis == "yaw" else f"{body}.position.{axis}")
    if quantity == "velocity":
        return Line(reading, f"{body}.velocity.{axis}")
    if quantity == "angular_velocity" and kind == "body":
        return Line(reading, f"{body}.angular_velocity.{axis}")
    return None


def _in_ascii(thing: str) -> str:
    """A body's own name as a channel has it."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", thing.removeprefix("body:")).strip("_") or "other"
