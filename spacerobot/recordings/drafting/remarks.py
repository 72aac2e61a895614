"""What a draft says beside its lines, and what only all files of a stream together say of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from spacerobot.recordings.drafting.columns import Reading
from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.groups import Group
from spacerobot.recordings.drafting.languages import words_in
from spacerobot.recordings.drafting.lines import Line
from spacerobot.recordings.drafting.machines import kind_of
from spacerobot.recordings.drafting.vocabulary import CONVERTER, THRUSTERS
from spacerobot.recordings.drafting.wrist import Drafted
from spacerobot.recordings.units import UNITS


def ask_what_no_name_says(drafted: Drafted, named: Mapping[str, Sequence[Reading]], does: str) -> None:
    """A question at each channel that its column's name does not bear out, but for events: those ask for all."""
    for stream, lines in drafted.lines.items():
        said = {r.column: (r.thing, r.quantity) for r in named[stream]}
        for line in lines:
            if said[line.reading.column] != (line.reading.thing, line.reading.quantity):
                asked = f"{line.channel} by what it {does}, not by its name: is it?"
                line.question = "; ".join(q for q in (asked, line.question) if q)


def second(group: Group, kind: str, found: Sequence[Reading]) -> str:
    """Why nothing is left to tell of a second body's or machine's log; "" where it is none."""
    if kind not in ("body", "platform", "arm") or kind_of({group.name: found}) != kind:
        return ""
    return f"{_files(group)}: its channels are another file's already; is it a second machine's log"


def say_who_names(lines: Mapping[str, Sequence[Line]], files: Mapping[str, Found]) -> None:
    """A remark at each channel whose column a list beside the file names."""
    for stream, found in lines.items():
        file = files[stream]
        for line in found if file.labels else ():
            label = f"{file.labels[line.reading.index]}, by {file.labelled_by}"
            line.remark = "; ".join(filter(None, (label, line.remark)))


def ask_what_counts(lines: Mapping[str, Sequence[Line]]) -> None:
    """A question at each channel of no unit whose name says that a converter or an encoder counts."""
    for line in (line for found in lines.values() for line in found):
        if line.reading.unit is None and not line.question and CONVERTER.intersection(words_in(line.reading.column)):
            line.question = "counts: state what one of them is, as scale or unit"


def ask_what_pushes(lines: Mapping[str, Sequence[Line]], left: Mapping[str, Sequence[str]], body: str) -> None:
    """A question at a body's first channel where columns of thrusters are left out, and no force is logged.

    Args:
        lines: stream -> its channels.
        left: stream -> columns that are no channel.
        body: what the body is called, "body" or "base".
    """
    channels = [line for found in lines.values() for line in found]
    pushing = [c for found in left.values() for c in found if THRUSTERS.intersection(_without_digits(c))]
    logged = any(line.channel.startswith((f"{body}.force", f"{body}.torque")) for line in channels)
    if not pushing or not channels or logged:
        return
    named = f"{', '.join(pushing[:3])}{', ...' if len(pushing) > 3 else ''}"
    asked = f'{named} push it, it seems: state what each does, as {body}.force.x and .y (frame = "body") and '
    asked += f'{body}.torque.yaw, with use = "input", scale [N] and plus'
    channels[0].question = "; ".join(filter(None, (channels[0].question, asked)))


def _without_digits(name: str) -> set[str]:
    return {word.rstrip("0123456789") for word in words_in(name)}


def unrecognised(group: Group) -> str:
    """Why a group became no stream."""
    fault = next((f.fault for f in group.files if f.fault), None)
    names = ", ".join(group.files[0].table.names()[:12])
    return fault or f"{_files(group)}: no column was recognised among {names}"


def _files(group: Group) -> str:
    """A group by its first file."""
    like = f" and {len(group.files) - 1} like it" if len(group.files) > 1 else ""
    return f"{group.files[0].relative}{like}"


def settle_by_all(lines: Mapping[str, Sequence[Line]], groups: Sequence[Group]) -> None:
    """Whether some file of a stream loses a track at 0, or has an angle start anew: what one shows, all may have."""
    for group in groups:
        for line in lines[group.name]:
            placed = line.reading.quantity == "position" and not line.reading.command
            line.lost = placed and any(line.reading.index in file.lost for file in group.files)
            if line.channel.endswith(".yaw") and line.reading.quantity == "position" and not line.moment:
                turn = math.pi / UNITS[line.reading.unit or "rad"].factor
                line.unwrap = line.unwrap or any(_jumps(file, line.reading.index) > turn for file in group.files)


def _jumps(file: Found, column: int) -> float:
    """The largest step of a column, in the file's unit; 0 where it has none."""
    steps = np.abs(np.diff(file.table.columns[column].values)) if column < len(file.table.columns) else np.zeros(0)
    return float(np.nanmax(steps)) if np.isfinite(steps).any() else 0.0
