"""Tables with a row for each event: the state just before it beside the state just after."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from spacerobot.recordings.drafting.columns import Reading
from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.languages import words_in
from spacerobot.recordings.drafting.lines import Line
from spacerobot.recordings.table import Floats

_MOMENTS = (("before", "after"), ("pre", "post"), ("initial", "final"), ("i", "f"), ("minus", "plus"))
"""What a moment just before an event and one just after are called, in pairs."""

_IN_ARRAY = re.compile(r"(.+)\[(\d)\]")
_STATES = {3: ("x", "y", "yaw"), 6: ("x", "y", "yaw", "x", "y", "yaw")}
"""Width of an array of states in a plane -> its axes by place; of six, three places and three rates."""

_DIRECTIONS = {
    "normal": ("n", "normal", "normals", "jn"),
    "tangent": ("d", "t", "tangent", "tangents", "tangential", "jt"),
}
"""A contact's direction -> what the rows of its Jacobian are called."""

_KEPT = 0.05
"""Share of its span by which a position may move in a hit, at the median: what moves more is a velocity."""


def event_lines(found: Sequence[Reading], file: Found) -> list[Line]:
    """The channels of a body's states before and after; none where the columns are no such pairs, or it has a clock."""
    if file.clock is not None:
        return []
    by_key: dict[tuple[str, ...], dict[str, Reading]] = {}
    for reading in found:
        for key, moment in _moments(file.table.names()[reading.index]):
            by_key.setdefault(key, {})[moment] = reading
    pairs = {key: both for key, both in by_key.items() if len(both) == 2}
    lines = []
    for key, both in pairs.items():
        name = _channel(both, [k for k in pairs if k[:-1] == key[:-1]], key, file)
        if name:
            lines += [Line(reading, name, moment=moment) for moment, reading in both.items()]
    velocities = any(".velocity." in line.channel for line in lines)
    alone = len({(line.channel, line.moment) for line in lines}) == len(lines)
    if not velocities or not alone:
        return []
    lines[0].question = "a row for each event, the state before and after: are these a body's, in m and rad?"
    told = {line.reading.column for line in lines}
    lines += _contact_rows([r for r in found if r.column not in told], file)
    return sorted(lines, key=lambda line: line.reading.index)


def _contact_rows(found: Sequence[Reading], file: Found) -> list[Line]:
    """The contact Jacobian's rows along x, y and yaw: arrays of three that are called after a direction."""
    lines: list[Line] = []
    for direction, called in _DIRECTIONS.items():
        own = []
        for reading in found:
            inside = _IN_ARRAY.fullmatch(file.table.names()[reading.index])
            if inside and words_in(inside.group(1))[-1:] and words_in(inside.group(1))[-1] in called:
                own.append((int(inside.group(2)), reading))
        if [place for place, _ in own] == [0, 1, 2]:
            lines += [Line(reading, f"aux.{direction}_{_STATES[3][place]}") for place, reading in own]
            lines[-3].remark = f"the contact Jacobian's row along its {direction}"
    return lines


def _moments(name: str) -> list[tuple[tuple[str, ...], str]]:
    """(all but the moment's word, moment) for each word of a name that may be one; an array's place comes last."""
    inside = _IN_ARRAY.fullmatch(name)
    words = words_in(inside.group(1) if inside else name)
    place = inside.group(2) if inside else ""
    return [
        ((str(n), *words[:n], *words[n + 1 :], place), moment)
        for n, word in enumerate(words)
        for pair in _MOMENTS
        for moment, called in zip(("before", "after"), pair, strict=True)
        if word == called
    ]


def _channel(both: dict[str, Reading], array: Sequence[tuple[str, ...]], key: tuple[str, ...], file: Found) -> str:
    """The channel of a pair: by its name's quantity and axis, or by its place in an array of states."""
    reading = both["before"]
    quantity, axis = reading.quantity, reading.axis
    if key[-1]:
        axes = _STATES.get(len(array), ())
        if not axes:
            return ""
        before, after = (_values(file, both[moment]) for moment in ("before", "after"))
        kept = float(np.nanmedian(np.abs(after - before))) < _KEPT * float(np.nanmax(before) - np.nanmin(before))
        if len(array) == 6 and kept != (int(key[-1]) < 3):
            return ""
        quantity, axis = "position" if kept else "velocity", axes[int(key[-1])]
    if quantity not in ("position", "velocity") or axis not in ("x", "y", "z", "yaw"):
        return ""
    return "body.yaw" if (quantity, axis) == ("position", "yaw") else f"body.{quantity}.{axis}"


def _values(file: Found, reading: Reading) -> Floats:
    return file.table.columns[reading.index].values
