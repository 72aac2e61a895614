"""Columns without names that say what they are by each other: a rate beside its angle, and what drives them.

The velocity of a column is another that is its change over time. Of two columns that are left, what moves has the
smoother one: a mass answers a force by its second integral. What is told so is asked, not stated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.recordings.drafting.approach import Track
from spacerobot.recordings.drafting.behaviour import FEW
from spacerobot.recordings.drafting.columns import Reading
from spacerobot.recordings.drafting.groups import Trial
from spacerobot.recordings.drafting.tracks import timed, track
from spacerobot.recordings.table import Floats

ALIKE = 0.99
"""Correlation of a velocity with its position's change; noise of a hundredth of a velocity's span leaves 0.99 to 1."""

SAME = 0.05
"""Share by which a velocity may differ from its position's change: by less than any two units do."""

SMOOTHER = 2.0
"""How many times an answer's bends, over its scatter, a drive's are at least."""

_AXES = ("x", "y", "yaw")

Role = tuple[str, str, str]
"""Thing, quantity and axis."""


def by_each_other(
    readings: Mapping[str, Sequence[Reading]], trials: Sequence[Trial], kind: str
) -> dict[str, list[Reading]]:
    """The readings with what silent columns are to each other.

    Args:
        readings: stream -> what its columns seem to be.
        trials: the trials.
        kind: of rig, where its author says it; "" lets one pair be an axis, and several be joints.
    """
    out: dict[str, list[Reading]] = {}
    for stream, found in readings.items():
        silent = [r for r in found if not r.thing and not r.quantity]
        some = [t for t in trials if stream in t.files][:FEW]
        moving = {r.column: own for r in silent if (own := _tracks(some, stream, r.column))}
        told = _told(moving, kind, timed=all(timed(t.files[stream]) for t in some))
        out[stream] = [_with_role(r, told[r.column]) if r.column in told else r for r in found]
    return out


def _with_role(reading: Reading, role: Role) -> Reading:
    thing, quantity, axis = role
    return replace(reading, thing=thing, quantity=quantity, axis=axis)


def rates(moving: Mapping[str, Sequence[Track]]) -> dict[str, str]:
    """Position -> the column that is its rate of change in every trial."""
    found: dict[str, str] = {}
    for position, own in moving.items():
        for rate, other in moving.items():
            if rate != position and all(_is_rate(a, b) for a, b in zip(own, other, strict=True)):
                found[position] = rate
    return found


def _told(moving: Mapping[str, Sequence[Track]], kind: str, *, timed: bool) -> dict[str, Role]:
    """Column -> what it is."""
    pairs = rates(moving) if timed else {}
    rest = [c for c in moving if c not in pairs and c not in pairs.values()]
    if kind in ("", "axis", "pendulum") and len(pairs) == 1 and len(rest) < 2:
        return _pairs(pairs, [("", "")]) | dict.fromkeys(rest, ("", "force", ""))
    if kind in ("", "axis") and not pairs and len(rest) == 2:
        rough = {c: float(np.median([_roughness(t.value) for t in moving[c]])) for c in rest}
        position, drive = sorted(rest, key=lambda c: rough[c])
        if rough[drive] > SMOOTHER * rough[position]:
            return {position: ("", "position", ""), drive: ("", "force", "")}
    elif kind in ("", "arm") and len(pairs) > 1 and not rest:
        return _pairs(pairs, [(f"joint:joint{n + 1}", "") for n in range(len(pairs))])
    elif kind == "body" and len(pairs) == len(_AXES):
        return _pairs(pairs, [("", axis) for axis in _AXES])
    return {}


def _pairs(pairs: Mapping[str, str], owners: Sequence[tuple[str, str]]) -> dict[str, Role]:
    """Positions and rates of things and axes."""
    told: dict[str, Role] = {}
    for (position, rate), (thing, axis) in zip(pairs.items(), owners, strict=True):
        told[position] = thing, "position", axis
        told[rate] = thing, "velocity", axis
    return told


def _tracks(trials: Sequence[Trial], stream: str, column: str) -> list[Track]:
    """The column in each trial; none where it stands still in one."""
    found = [own for t in trials if (own := track(t.files[stream], column)) is not None and np.ptp(own.value) > 0.0]
    return found if len(found) == len(trials) else []


def _is_rate(own: Track, other: Track) -> bool:
    if len(own.time) != len(other.time) or len(own.time) < 5:
        return False
    span = own.time[2:] - own.time[:-2]
    with np.errstate(divide="ignore", invalid="ignore"):
        change = (own.value[2:] - own.value[:-2]) / span
    rate = other.value[1:-1]
    good = np.isfinite(change)
    if good.sum() < 5 or not np.std(change[good]) > 0.0 or not np.std(rate[good]) > 0.0:
        return False
    alike = float(np.corrcoef(change[good], rate[good])[0, 1])
    slope = float(np.polyfit(change[good], rate[good], 1)[0])
    return alike > ALIKE and abs(slope - 1.0) < SAME


def _roughness(value: Floats) -> float:
    """Scatter of the bends (second differences) over the readings' own."""
    return float(np.std(np.diff(value, 2)) / np.std(value))
