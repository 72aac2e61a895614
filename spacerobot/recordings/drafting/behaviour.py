"""A wrist rig whose columns have names that say nothing: told by what a target, a slider and a force do in a hit.

A target drifts from the start and is turned back. A slider rests until then and is pushed as far as the target goes on;
a force rests until then too, and goes by another measure. What is told so is asked, not stated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.recordings.drafting.approach import CLEAR, Rest, Track, drift, rest
from spacerobot.recordings.drafting.columns import Reading, stem_of
from spacerobot.recordings.drafting.groups import Trial
from spacerobot.recordings.drafting.shapes import in_steps, turn_of
from spacerobot.recordings.drafting.tracks import track
from spacerobot.recordings.series import estimate_noise
from spacerobot.recordings.units import UNITS

FEW = 4
"""Trials that are looked at; a thing is told where it is told alike in most of them."""

ALIKE = 0.15
"""Share by which a slider's push may differ from how far the target goes on: bounces, and the contact's own give."""

AT_ALL_ALIKE = 0.5
"""The same of what is called a hand: an arm behind the spring gives a fraction of it, a contact as much as a half."""

_MEANT = {"target": ("target", "position"), "wrist": ("wrist", "position"), "force": ("", "force")}
"""Role -> thing and quantity."""

Role = str
""" "target", "wrist" or "force"."""


def by_behaviour(
    readings: Mapping[str, Sequence[Reading]], trials: Sequence[Trial], *, slider: bool = False
) -> dict[str, list[Reading]] | None:
    """The readings with what their columns do in place of what their names do not say; None where no hit shows.

    Args:
        readings: stream -> what its columns seem to be.
        trials: the trials.
        slider: whether only a slider shows a hit: a thrust bends a free body's track too.
    """
    votes: dict[tuple[str, str], list[Role]] = {}
    some = trials[:FEW]
    for trial in some:
        for place, role in _roles(readings, trial).items():
            votes.setdefault(place, []).append(role)
    told = {place: roles[0] for place, roles in votes.items() if len(set(roles)) == 1 and 2 * len(roles) > len(some)}
    roles = list(told.values())
    if roles.count("target") != 1 or not ({"wrist"} if slider else {"wrist", "force"}) & set(roles):
        return None
    out: dict[str, list[Reading]] = {}
    for stream, found in readings.items():
        tip = any(_a_hand(r) and (stream, r.column) in told for r in found)
        for reading in found:
            own = reading
            if tip and _a_hand(reading):
                own = replace(reading, thing="wrist")
            elif not reading.thing and (stream, reading.column) in told:
                thing, quantity = _MEANT[told[stream, reading.column]]
                own = replace(reading, thing=thing, quantity=quantity, axis="")
            out.setdefault(stream, []).append(own)
    return out


def with_slider(readings: Mapping[str, Sequence[Reading]], trials: Sequence[Trial]) -> dict[str, list[Reading]]:
    """The readings, with the wrist where none is called so: what is pushed as far as the target goes on."""
    told = by_behaviour(readings, trials, slider=True) or readings
    return {
        stream: [
            new if new.thing == "wrist" and old.quantity != "force" else old
            for old, new in zip(found, told[stream], strict=True)
        ]
        for stream, found in readings.items()
    }


def _a_hand(reading: Reading) -> bool:
    """Whether a column is called a hand's place: the hand proper is behind the spring, a tip goes with the target."""
    return reading.thing == "hand" and reading.quantity == "position" and not reading.command


def with_target(readings: Mapping[str, Sequence[Reading]], trials: Sequence[Trial]) -> dict[str, list[Reading]]:
    """The readings, with the target where none is called so: what drifts until the touch, and its other axes."""
    told = by_behaviour(readings, trials)
    if told is None:
        return {stream: list(found) for stream, found in readings.items()}
    out: dict[str, list[Reading]] = {}
    for stream, found in readings.items():
        place = next((n for n, new in enumerate(told[stream]) if new.thing == "target" and not found[n].thing), None)
        out[stream] = list(found)
        if place is None:
            continue
        drifts = found[place]
        if drifts.quantity == "position" and drifts.axis and (stem := stem_of(drifts.column)):
            own = [r.quantity == "position" and not r.thing and stem_of(r.column) == stem for r in found]
            out[stream] = [replace(r, thing="target") if mine else r for r, mine in zip(found, own, strict=True)]
        else:
            out[stream][place] = told[stream][place]
    return out


def _roles(readings: Mapping[str, Sequence[Reading]], trial: Trial) -> dict[tuple[str, str], Role]:
    """(stream, column) -> its role in one trial."""
    moving: dict[tuple[str, str], tuple[tuple[bool, float], Track]] = {}
    pushed: dict[tuple[str, str], tuple[Track, Rest]] = {}
    metres: dict[tuple[str, str], float] = {}
    named: set[tuple[str, str]] = set()
    wristless = not any(r.thing == "wrist" for found in readings.values() for r in found)
    for stream, found in readings.items():
        for reading in found if stream in trial.files else ():
            own = track(trial.files[stream], reading.column)
            slid = _a_hand(reading) if wristless else reading.thing == "wrist" and reading.quantity == "position"
            if reading.command or not (slid or reading.thing in ("", "target")) or own is None:
                continue
            if in_steps(own.value) or turn_of(own.value):
                continue  # a status, or an angle that starts anew
            if reading.unit and UNITS[reading.unit].dimension == "length":
                metres[stream, reading.column] = UNITS[reading.unit].factor
            if reading.thing and not slid:
                if reading.quantity == "position":
                    moving[stream, reading.column] = (True, _turned_back(own)), own
                continue
            still = rest(own)
            if slid:
                named.add((stream, reading.column))
            if still is not None and still.leaves is not None and _strength(own, still) > 2 * CLEAR:
                pushed[stream, reading.column] = own, still
            elif still is None and not slid and (bent := _turned_back(own)) > 0.0:
                moving[stream, reading.column] = (False, bent), own
    if not moving or not pushed:
        return {}
    place = max(moving, key=lambda p: moving[p][0])
    target = moving[place][1]
    same = metres.get(place, 1.0)
    further = {  # what states no unit is taken to be in the target's
        p: _share(target, own, still) * same / metres.get(p, same) for p, (own, still) in pushed.items()
    }
    slider = min(further, key=lambda p: abs(further[p] - 1.0))
    out = {place: "target"}
    if abs(further[slider] - 1.0) < (AT_ALL_ALIKE if wristless and slider in named else ALIKE):
        out[slider] = "wrist"
    forces = {p: _strength(*pushed[p]) for p in pushed if p not in named and (p != slider or slider not in out)}
    if forces:
        out[max(forces, key=lambda p: forces[p])] = "force"
    return out


def _strength(own: Track, still: Rest) -> float:
    """The furthest from rest, in sigmas."""
    return float(np.max(np.abs(own.value - still.zero))) / still.sigma


def _turned_back(own: Track) -> float:
    """How far, in sigmas, a track ends from where its first drift would have led; 0 where it does not drift."""
    free = drift([own], None)
    sigma = estimate_noise(own.value)
    if free is None or not sigma > 0.0:
        return 0.0
    went = abs(free.velocity[0]) * (free.end - free.start)
    within = own.time < free.end
    ahead = np.median(own.value[within]) + free.velocity[0] * (own.time[-1] - np.median(own.time[within]))
    return abs(float(ahead - own.value[-1])) / sigma if went > 2 * CLEAR * sigma else 0.0


def _share(target: Track, own: Track, still: Rest) -> float:
    """How far the target moves while a sensor is beyond half of its peak, over how far the sensor does (rms)."""
    away = np.abs(own.value - still.zero)
    peak = int(np.argmax(away))
    less = np.flatnonzero(away < 0.5 * away[peak])
    before, after = less[less < peak], less[less > peak]
    if not len(before):
        return 0.0
    pushed = slice(before[-1] + 1, after[0] if len(after) else None)
    went = np.interp(own.time[pushed], target.time, target.value)
    spread = np.var(away[pushed]) - still.sigma**2
    moved = np.var(went) - estimate_noise(target.value) ** 2
    return float(np.sqrt(moved / spread)) if moved > 0.0 and spread > 0.0 else 0.0
