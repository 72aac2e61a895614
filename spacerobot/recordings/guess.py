"""What a column probably is, by its name: a first word for a study that its author then corrects."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from spacerobot.recordings.drafting.languages import english
from spacerobot.recordings.table import Column, Floats, RawTable
from spacerobot.recordings.units import UNITS

_TIME = re.compile(r"^(?:t|time|times|timestamp|stamp|zeit|rt_tout|sec|secs|seconds|elapsed|clock)(?:$|[\W_])", re.I)
_BRACKETED = re.compile(r"[\[(]\s*([^\])]+?)\s*[\])]\s*$")

SLOWEST = 1.0
"""Longest step of a recording of anything that moves, s: what is slower by its numbers is not in seconds."""

DAYS = ((729_000.0, 767_011.0), (36_525.0, 73_051.0))
"""Days that MATLAB (from the year 0) and spreadsheets (from 1900) count for dates from 1995 or 2000 to 2100."""

UNTIMED = 100.0
"""Readings a second of a file without a clock, until its author says [Hz]."""

LATEST = 1.0
"""Longest that a message waits to be recorded [s]; two clocks that nobody set differ by more."""

_STAMP = re.compile(r"header\W?stamp$", re.I)

_TURN = re.compile(r"\b(?:rotation|quat\w*|orientation)\b", re.I)
"""Parts of a quaternion, whose x is no position."""

_RULES: tuple[tuple[str, str], ...] = (
    (r"(target|satellite|body).*(yaw|theta|heading)|(yaw|theta|heading).*(target|satellite)", "target.yaw"),
    (r"target.*(pos\w*)?\W*x|x\W*target", "target.x"),
    (r"target.*(pos\w*)?\W*y|y\W*target", "target.y"),
    (r"(wrist|slider|spring|carriage).*x|x\W*(wrist|slider|carriage)", "wrist.x"),
    (r"hand\W*(pos\w*)?\W*x|x\W*hand", "hand.x"),
    (r"contact\W*f|f\W*contact|contact\W*force|force\W*contact|load\W*cell|^f(orce)?(\W*(n|x))?$", "contact.force"),
)
"""Pattern over the lower-case name (underscores as blanks) -> channel; the first that fits."""

_JOINT = re.compile(
    r"^(?:joint\W*)?(dq|qd|qdot|tau|torque|q|pos|position|vel|velocity|effort)\W*\[?(\d{1,2})\]?$", re.I
)
_JOINT_KIND = {
    "q": "position",
    "pos": "position",
    "position": "position",
    "dq": "velocity",
    "qd": "velocity",
    "qdot": "velocity",
    "vel": "velocity",
    "velocity": "velocity",
    "tau": "torque",
    "torque": "torque",
    "effort": "torque",
}


@dataclass(frozen=True)
class Guess:
    """What a column may be.

    Attributes:
        column: how the study names it.
        channel: canonical channel, "aux.NAME" where the name says nothing.
        unit: unit that the name states and that is not SI, else None.
        stated: unit that name or file states, SI or not.
    """

    column: str
    channel: str
    unit: str | None
    stated: str | None = None


def is_time(column: Column) -> bool:
    """Whether the column's name and values are those of a clock."""
    return any(map(is_called_time, column.names)) and runs_forward(column.values)


def is_called_time(name: str) -> bool:
    """Whether a name is that of a clock."""
    return bool(_TIME.match(english(name).strip()))


def _in_seconds(column: Column) -> bool:
    """Whether a unit of time is stated, in whatever language the name is, and the values are those of a clock."""
    stated = [column.unit, *map(_unit, column.names)]
    return any(u in UNITS and UNITS[u].dimension == "time" for u in stated if u) and runs_forward(column.values)


def runs_forward(values: Floats) -> bool:
    """Whether the values only grow, and by about the same step."""
    if len(values) < 3 or not np.isfinite(values).all():
        return False
    step = np.diff(values)
    return bool((step >= 0).all() and np.median(step) > 0 and (step < 20 * np.median(step)).mean() > 0.95)


def find_time(table: RawTable) -> int | None:
    """Index of the clock: by name, by a unit of time, else the first that runs forward in steps below a second.

    Of a message's two times, when it was made and when it was recorded, the first: on its way it waits by chance. But
    only where the two are one clock's.
    """
    for told in (is_time, _in_seconds):
        for index, column in enumerate(table.columns):
            if told(column):
                made = (j for j, other in enumerate(table.columns) if _is_when_made(other, column))
                return next(made, index)
    for index, column in enumerate(table.columns):
        if runs_forward(column.values) and np.median(np.diff(column.values)) < 1.0:
            return index
    return None


def _is_when_made(column: Column, recorded: Column) -> bool:
    """Whether the column is a message's own stamp, by the clock that `recorded` is read from."""
    stamped = any(_STAMP.search(name) for name in column.names) and runs_forward(column.values)
    if not stamped or column is recorded or len(column.values) != len(recorded.values):
        return False
    made, taken = (c.values * UNITS[time_unit(c)].factor for c in (column, recorded))
    return bool(np.all(np.abs(taken - made) < LATEST))


def time_unit(column: Column) -> str:
    """ "ms", "us" or "ns" where name or file say so or seconds since 1970 are of that size, "d" for dates; else "s"."""
    text = " ".join((*column.names, column.unit or ""))
    found = re.search(r"(?:^|[\W_])(ms|msec|us|µs|usec|ns|nsec)(?:$|[\W_])", text, re.I)
    if found:
        return {"m": "ms", "u": "us", "µ": "us", "n": "ns"}[found.group(1)[0].lower()]
    middle = float(np.nanmedian(column.values)) if len(column.values) else 0.0
    if any(low < middle < high for low, high in DAYS) and 0.0 < _step(column) < UNITS["s"].factor / UNITS["d"].factor:
        return "d"
    return next((unit for unit in ("ms", "us", "ns") if _since_1970(middle * UNITS[unit].factor)), "s")


def _step(column: Column) -> float:
    return float(np.nanmedian(np.diff(column.values))) if len(column.values) > 1 else 0.0


def unsaid_unit(column: Column) -> str | None:
    """The unit that a clock's steps ask for where nothing states it and seconds would be too slow; None elsewhere."""
    text = " ".join((*column.names, column.unit or ""))
    step = _step(column)
    said = time_unit(column) != "s" or re.search(r"(?:^|[\W_])(?:s|sec|secs|seconds)(?:$|[\W_])", text, re.I)
    if said or step < SLOWEST:
        return None
    return next((unit for unit in ("ms", "us", "ns") if step * UNITS[unit].factor < SLOWEST), None)


def _since_1970(seconds: float) -> bool:
    """Whether so many seconds after 1970 a computer may have logged: 2001 to 2100."""
    return 9.8e8 < seconds < 4.2e9


def guess(name: str, stated: str | None = None) -> Guess:
    """What the column called `name` may be.

    Args:
        name: the column's name.
        stated: unit that the file states.
    """
    unit = stated or _unit(name)
    plain = re.sub(r"[\s_.:]+", " ", _BRACKETED.sub("", name)).strip().lower()
    joint = _JOINT.match(plain.replace(" ", ""))
    if joint:
        channel = f"joint.joint{int(joint.group(2))}.{_JOINT_KIND[joint.group(1).lower()]}"
    elif _TURN.search(plain):
        channel = ""
    else:
        channel = next((c for pattern, c in _RULES if re.search(pattern, plain)), "")
    if not channel or not _fits(channel, unit):
        channel = f"aux.{re.sub(r'[^A-Za-z0-9_-]+', '_', name).strip('_') or 'column'}"
    return Guess(name, channel, unit if unit and UNITS[unit].factor != 1.0 else None, unit)


def _unit(name: str) -> str | None:
    bracketed = _BRACKETED.search(name)
    for said in (bracketed.group(1), english(bracketed.group(1)).strip()) if bracketed else ():
        if said in UNITS and not said.isdigit():
            return said
    *before, last = re.split(r"[_\s]", name.strip())
    for said in ("/".join([*before[-1:], last]), last) if before else ():  # "speed_mm_s" is in mm/s
        if said in UNITS and not said.isdigit():
            return said
    return None


def _fits(channel: str, unit: str | None) -> bool:
    from spacerobot.recordings.channel import dimensions

    return unit is None or UNITS[unit].dimension in dimensions(channel)
