"""A wrist rig: which columns are its channels, with signs, zeroes and noise from the free approach."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from spacerobot.recordings.drafting.approach import CERTAIN, Rest, Track, contact_zero, drift, rest
from spacerobot.recordings.drafting.clocks import out_of_step, runs_apart, turned
from spacerobot.recordings.drafting.columns import Reading
from spacerobot.recordings.drafting.groups import Trial
from spacerobot.recordings.drafting.lines import LARGEST_RIG, Line
from spacerobot.recordings.drafting.tracks import span, track, values
from spacerobot.recordings.series import estimate_noise
from spacerobot.recordings.units import UNITS

MOST_TRIALS = 16
"""Trials whose approach is looked at; zeroes and noise are medians over them."""

ALONG = 1e-3
"""Share of the travel that an axis may miss and still be taken for its direction: a tenth of what labs know
a spring to (1 %)."""


NO_DELAY = 0.1
"""Later than any filter or cable makes a reading [s]: two streams further apart have clocks of their own."""


@dataclass
class Drafted:
    """What became of the streams.

    Attributes:
        lines: stream -> its channels.
        own_clock: stream -> why its clock is another's than the cameras'.
    """

    lines: dict[str, list[Line]] = field(default_factory=dict)
    own_clock: dict[str, str] = field(default_factory=dict)


def is_wrist(readings: Mapping[str, Sequence[Reading]]) -> bool:
    """Whether a target is tracked, and the wrist that it meets or the force between them is measured."""
    every = [r for found in readings.values() for r in found if not r.command]
    target = any(r.thing == "target" and r.quantity == "position" for r in every)
    wrist = any(r.thing == "wrist" and r.quantity == "position" for r in every)
    return wrist or (target and any(r.quantity == "force" for r in every))


def draft_wrist(readings: Mapping[str, Sequence[Reading]], trials: Sequence[Trial]) -> Drafted:
    """The channels of a wrist rig.

    Args:
        readings: stream -> what its columns seem to be.
        trials: the trials.
    """
    drafted = Drafted()
    places = {thing: _tracked(readings, thing) for thing in ("target", "wrist", "hand")}
    some = trials[:: max(1, len(trials) // MOST_TRIALS)][:MOST_TRIALS]
    rests = _wrist_rests(places["wrist"], some)
    cameras = places["target"][0]
    late = _turns_later(places, some, rests)
    own = runs_apart(some, places["wrist"][0], cameras) or _of_its_own(list(late.values()), cameras)
    if own:
        drafted.own_clock[places["wrist"][0]] = own
        seen = {i: r for i, r in rests.items() if i in late and r.leaves is not None}
        rests = {i: replace(r, leaves=(r.leaves or 0.0) + late[i]) for i, r in seen.items()}
    travel = _travel(places["target"], some, rests)
    for thing, (stream, columns) in places.items():
        line = _along(thing, columns, travel)
        if line is None:
            continue
        tracks = [t for trial in some if (t := _combined(trial, stream, line)) is not None]
        if thing == "wrist" and _pushed(tracks) < 0:
            line.scale, tracks = -line.scale, [Track(t.time, -t.value) for t in tracks]
            if line.reading.axis and line.reading.axis in travel:
                line.remark = "turned round against its axis: a target pushes a wrist its own way"
        line.sigma = _median([estimate_noise(t.value) for t in tracks])
        if thing == "target":
            line.question = _too_far_for_metres(line, tracks)
        elif zeros := [r for r in map(rest, tracks) if r is not None]:
            line.offset, line.offset_sigma = _zero(zeros, line.scale)
        drafted.lines.setdefault(stream, []).append(line)
    _in_millimetres(drafted)
    _place_target(drafted, places, some)
    yaw = next((r for r in _of(readings, "target", places["target"][0]) if r.axis == "yaw" and not r.command), None)
    if yaw is not None and yaw.quantity == "position":
        stream = places["target"][0]
        noise = _median([estimate_noise(values(t.files[stream], yaw.column)) for t in some if stream in t.files])
        drafted.lines[stream].append(Line(yaw, "target.yaw", sigma=noise, unwrap=True))
    _place_force(drafted, readings, some, places, rests)
    return drafted


def _of(readings: Mapping[str, Sequence[Reading]], thing: str, stream: str) -> list[Reading]:
    return [r for r in readings.get(stream, ()) if r.thing == thing]


def _tracked(readings: Mapping[str, Sequence[Reading]], thing: str) -> tuple[str, list[Reading]]:
    """The stream that tracks a thing, and its position along each axis it has."""
    for stream, found in readings.items():
        columns = [r for r in found if r.thing == thing and r.quantity == "position" and not r.command]
        columns = [r for r in columns if r.axis in ("", "x", "y", "z")]
        own = list({r.axis: r for r in reversed(columns)}.values())[::-1]
        if own:
            return stream, own
    return "", []


def _combined(trial: Trial, stream: str, line: Line) -> Track | None:
    """What the line makes of a trial's file, before its offset."""
    if stream not in trial.files:
        return None
    file = trial.files[stream]
    total = line.scale * values(file, line.reading.column)
    for column, factor in line.plus.items():
        total = total + factor * values(file, column)
    return track(file, line.reading.column, total)


def _wrist_rests(place: tuple[str, list[Reading]], trials: Sequence[Trial]) -> dict[str, Rest]:
    """Trial -> the rest of the wrist's axis that moves first and most."""
    stream, columns = place
    found: dict[str, Rest] = {}
    for trial in trials:
        if stream not in trial.files:
            continue
        seen = [rest(t) for c in columns if (t := track(trial.files[stream], c.column)) is not None]
        moved = [r for r in seen if r is not None and r.leaves is not None]
        if moved:
            found[trial.id] = min(moved, key=lambda r: r.leaves or math.inf)
    return found


def _travel(place: tuple[str, list[Reading]], trials: Sequence[Trial], rests: Mapping[str, Rest]) -> dict[str, float]:
    """Axis -> component of the target's direction of travel, from its free drift."""
    stream, columns = place
    total = np.zeros(len(columns))
    for trial in trials:
        if stream not in trial.files:
            continue
        axes = [track(trial.files[stream], c.column) for c in columns]
        if any(a is None for a in axes):
            continue
        until = rests[trial.id].leaves if trial.id in rests else None
        found = drift([a for a in axes if a is not None and len(a.time) == len(axes[0].time)], until)  # type: ignore[union-attr]
        if found is not None and len(found.velocity) == len(columns) and np.linalg.norm(found.velocity) > 0:
            total += np.array(found.velocity)
    length = float(np.linalg.norm(total))
    return {c.axis: float(v) for c, v in zip(columns, total / length, strict=True)} if length > 0 else {}


def _along(thing: str, columns: Sequence[Reading], travel: Mapping[str, float]) -> Line | None:
    """A thing's position along the travel: one axis, or the sum of several where none of them keeps to it."""
    if not columns:
        return None
    known = [c for c in columns if c.axis in travel]
    if not known:
        sign = np.sign(next(iter(travel.values()))) if len(travel) == 1 else 1.0
        return Line(columns[0], f"{thing}.x", scale=float(sign))
    known = sorted(known, key=lambda c: -abs(travel[c.axis]))
    first = known[0]
    if 1 - abs(travel[first.axis]) <= ALONG or len(known) == 1:
        return Line(first, f"{thing}.x", scale=float(np.sign(travel[first.axis]) or 1.0))
    rest_of = {c.column: travel[c.axis] for c in known[1:] if abs(travel[c.axis]) > ALONG}
    line = Line(first, f"{thing}.x", scale=travel[first.axis], plus=rest_of)
    line.remark = "along the direction of travel"
    return line


def _pushed(tracks: Sequence[Track]) -> int:
    """Which way most tracks first leave their rest."""
    return sum(r.sign for r in map(rest, tracks) if r is not None and r.leaves is not None)


def _median(values: Sequence[float]) -> float | None:
    good = [v for v in values if math.isfinite(v) and v > 0]
    return float(np.median(good)) if good else None


def _zero(rests: Sequence[Rest], scale: float) -> tuple[float, float]:
    """The offset that takes the reading at rest off (0 where it is certain to be none), and its error."""
    zeros = np.array([r.zero for r in rests])
    spread = float(np.std(zeros, ddof=1)) if len(zeros) > 1 else 0.0
    error = max(float(np.median([r.error for r in rests])), spread) / math.sqrt(len(zeros))
    zero = float(np.median(zeros))
    return (_round(-zero, error), error) if abs(zero) > CERTAIN * error else (0.0, error)


def _round(value: float, error: float) -> float:
    """`value` to a tenth of its error."""
    if not (error > 0 and math.isfinite(error)):
        return value
    return round(value, max(0, 1 - math.floor(math.log10(error))))


def _turns_later(
    places: Mapping[str, tuple[str, list[Reading]]], trials: Sequence[Trial], rests: Mapping[str, Rest]
) -> dict[str, float]:
    """Trial -> how much later by the cameras' clock than by the wrist's own the two turn back together, s."""
    (cameras, columns), (stream, sliders) = places["target"], places["wrist"]
    if not columns or not sliders or stream == cameras:
        return {}
    same = UNITS[sliders[0].unit or "m"].factor / UNITS[columns[0].unit or "m"].factor
    found: dict[str, float] = {}
    for trial in trials:
        if trial.id not in rests or cameras not in trial.files:
            continue
        moved = [t for c in sliders if (t := track(trial.files[stream], c.column)) is not None]
        bodies = [t for c in columns if (t := track(trial.files[cameras], c.column)) is not None]
        if not moved or not bodies:
            continue
        slider, body = max(moved, key=_far), max(bodies, key=_far)
        forward = float(np.sign(np.median(body.value[: len(body.value) // 4]) - body.value[0])) or 1.0
        pushed = Track(slider.time, same * rests[trial.id].sign * slider.value)
        still = rest(pushed)
        late = turned(Track(body.time, forward * body.value), pushed, still) if still is not None else None
        if late is not None:
            found[trial.id] = late
    return found


def _of_its_own(late: Sequence[float], cameras: str) -> str:
    """Why a wrist's clock is not the cameras', by how much later these see it turn back; "" where it is theirs."""
    if not late or not float(np.median(np.abs(late))) > NO_DELAY:
        return ""
    return f"it turns back {np.min(late):.3g} to {np.max(late):.3g} s before {cameras} does"


def _far(own: Track) -> float:
    return float(np.ptp(own.value))


def _place_target(drafted: Drafted, places: Mapping[str, tuple[str, list[Reading]]], trials: Sequence[Trial]) -> None:
    """The target's zero: where it touches the resting wrist."""
    lines = {line.channel: (stream, line) for stream, found in drafted.lines.items() for line in found}
    if "target.x" not in lines or "wrist.x" not in lines:
        return
    (stream, target), (wrist_stream, wrist) = lines["target.x"], lines["wrist.x"]
    same = UNITS[target.reading.unit or "m"].factor / UNITS[wrist.reading.unit or "m"].factor
    zeros: list[float] = []
    errors: list[float] = []
    for trial in trials:
        body, slider = _combined(trial, stream, target), _combined(trial, wrist_stream, wrist)
        if body is None or slider is None:
            continue
        scaled = Track(slider.time, slider.value / same)
        still = rest(scaled)
        if still is None:
            continue
        if still.sign < 0:
            wrist.question = "the wrist moves against the target: is its sign right?"
        if stream in drafted.own_clock or wrist_stream in drafted.own_clock:
            late = turned(body, scaled, still)
            if late is None or still.leaves is None:
                continue
            scaled, still = Track(scaled.time + late, scaled.value), replace(still, leaves=still.leaves + late)
        found = contact_zero(body, scaled, still, 1)
        if found is not None:
            zeros.append(found[0])
            errors.append(found[1])
    if not zeros:
        target.question = target.question or "offset: target.x must be 0 where the target first touches the wrist"
        return
    # Of one trial, no better than a reading: what the fit's own error leaves out shows only between trials.
    spread = 1.2533 * float(np.std(zeros, ddof=1)) / math.sqrt(len(zeros)) if len(zeros) > 1 else target.sigma or 0.0
    error = max(spread, errors[0]) if len(zeros) == 1 else spread
    zero = float(np.median(zeros))
    if abs(zero) > CERTAIN * error:
        target.offset, target.offset_sigma = _round(-zero, error), error
        target.remark = "0 where it touches the wrist"


def _too_far_for_metres(line: Line, tracks: Sequence[Track]) -> str:
    """A question where no unit is stated and metres would make the rig larger than any."""
    if line.reading.unit is not None or not tracks:
        return ""
    span = max(float(np.ptp(t.value)) for t in tracks)
    return f"no unit is stated, and readings span {span:.3g}: are they mm" if span > LARGEST_RIG else ""


def _in_millimetres(drafted: Drafted) -> None:
    """Where a target without a unit goes too far for metres, mm for it and for all that is tracked without a unit."""
    lines = [
        x for found in drafted.lines.values() for x in found if x.reading.unit is None and x.channel.endswith(".x")
    ]
    if any(x.channel == "target.x" and x.question for x in lines):
        for line in lines:
            line.reading = replace(line.reading, unit="mm")


def _place_force(
    drafted: Drafted,
    readings: Mapping[str, Sequence[Reading]],
    trials: Sequence[Trial],
    places: Mapping[str, tuple[str, list[Reading]]],
    wrists: Mapping[str, Rest],
) -> None:
    """The component with the pulse, positive in compression, and whether its clock is the cameras'."""
    found_forces: list[tuple[float, str, Reading, dict[str, Rest]]] = []
    for stream, found in readings.items():
        for reading in found:
            if reading.quantity != "force" or reading.command:
                continue
            rests: dict[str, Rest] = {}
            peaks: list[float] = []
            swings: list[float] = []
            for trial in trials:
                one = track(trial.files[stream], reading.column) if stream in trial.files else None
                still = rest(one) if one is not None else None
                swings += [_far(one)] if one is not None else []
                if one is None or still is None or still.leaves is None:
                    continue
                rests[trial.id] = still
                peaks.append(float(np.max(np.abs(one.value - still.zero))))
            newton = UNITS[reading.unit or "N"].factor
            found_forces.append((newton * float(np.median(peaks or swings or [0.0])), stream, reading, rests))
    if not found_forces:
        return
    most = max(len(rests) for _, _, _, rests in found_forces)
    # By newtons, not by sigmas: cross-talk has the signal's noise as well as its pulse, and is as clear.
    _, stream, reading, rests = max((f for f in found_forces if 2 * len(f[3]) >= most), key=lambda f: f[0])
    line = Line(reading, "contact.force")
    if not rests:
        line.question = "no pulse was seen in any trial: is this the contact force?"
        line.sigma = _median(
            [estimate_noise(values(t.files[stream], reading.column)) for t in trials if stream in t.files]
        )
    else:
        line.scale = float(np.sign(sum(r.sign for r in rests.values())) or 1.0)
        line.sigma = _median([r.sigma for r in rests.values()])
        line.offset = line.scale * _zero(list(rests.values()), line.scale)[0]
        line.remark = "the component with the pulse" if line.scale > 0 else "the component with the pulse, turned round"
    drafted.lines.setdefault(stream, []).append(line)
    cameras = places["target"][0]
    if stream != cameras:
        # Rows without a clock say nothing of the cameras'.
        untimed = any(span(t.files[s]) is None for t in trials for s in (stream, places["wrist"][0]) if s in t.files)
        why = runs_apart(trials, stream, cameras)
        why = why or ("" if untimed else out_of_step(trials, rests, wrists, _speeds(trials, places["target"], wrists)))
        if why:
            drafted.own_clock[stream] = why


def _speeds(trials: Sequence[Trial], place: tuple[str, list[Reading]], wrists: Mapping[str, Rest]) -> dict[str, float]:
    """Trial -> how fast the target comes along its fastest axis, file's unit per second; 0 where that is unknown."""
    found: dict[str, float] = {}
    for trial in trials:
        if place[0] not in trial.files or trial.id not in wrists:
            continue
        whole = [b for c in place[1] if (b := track(trial.files[place[0]], c.column)) is not None]
        free = drift(whole, wrists[trial.id].leaves) if whole and len({len(b.time) for b in whole}) == 1 else None
        found[trial.id] = max((abs(v) for v in free.velocity), default=0.0) if free else 0.0
    return found
