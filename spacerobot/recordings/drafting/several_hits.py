"""A recording of a whole session: each hit in it is a trial of its own, in its window of the recording's time.

One of a single hit has a window where somebody's hand still pushes the target at its beginning, or stops it at its end.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.recordings.drafting.approach import CLEAR, FEWEST, Track, straight
from spacerobot.recordings.drafting.columns import Reading
from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.groups import Trial, unused
from spacerobot.recordings.drafting.names import identifier
from spacerobot.recordings.drafting.tracks import clock, span, track
from spacerobot.recordings.series import estimate_noise
from spacerobot.recordings.table import Floats

PUSHED = 0.1
"""Share of the hardest push from which a sensor counts as pushed: a guide's friction holds it off its zero by less."""

BY_HAND = 0.1
"""Share of a free drift that is left out at its outer end, where a hand may still have held the target."""

HELD = 0.5
"""Share of its speed beside the hit below which, at the recording's end, a hand has not let go of a target or has
caught it: neither drag nor a table's tilt takes as much on the way."""

MOVES = 0.1
"""Share of the speed it came with at which a target leaves; slower, nothing tells whether it was caught."""

Window = tuple[float, float]
"""First and last time, s."""


def apart(readings: Mapping[str, Sequence[Reading]], trials: Sequence[Trial]) -> list[Trial]:
    """The trials, each recording of several hits as one trial for each.

    Args:
        readings: stream -> what its columns seem to be.
        trials: a trial for each recording.
    """
    found: list[Trial] = []
    held: list[Trial] = []
    taken = {t.id for t in trials}
    for trial in trials:
        windows = _windows(readings, trial)
        if not windows:
            found.append(trial)
            continue
        if len(windows) == 1:
            held.append(_in_window(trial, windows[0]))
            found.append(held[-1])
            continue
        for n, window in enumerate(windows, 1):
            name = unused(identifier(f"{trial.id}_{n:02d}"), taken)
            taken.add(name)
            asked = f"{len(windows)} hits in one recording: is the target left alone in each window" if n == 1 else None
            found.append(replace(_in_window(trial, window), id=name, question=asked))
    if held:
        asked = f"a hand seems to hold the target at an end of {len(held)} recordings: is it left alone in each window"
        held[0].question = "; ".join(filter(None, (held[0].question, asked)))
    return found


def _in_window(trial: Trial, window: Window) -> Trial:
    """A trial with what its files hold in the window."""
    cut = {stream: within(file, window) for stream, file in trial.files.items()}
    return replace(trial, files=cut, window=window)


def within(file: Found, window: Window) -> Found:
    """A file's rows whose times are in the window."""
    time = clock(file)
    if time is None:
        return file
    rows = np.flatnonzero((time >= window[0]) & (time <= window[1]))
    if not len(rows):
        return file
    part = slice(int(rows[0]), int(rows[-1]) + 1)
    columns = tuple(replace(c, values=c.values[part]) if len(c.values) == len(time) else c for c in file.table.columns)
    lines = None if file.table.lines is None else file.table.lines[part]
    times = None if file.times is None else (*file.times[:2], time[part])
    return replace(file, table=replace(file.table, columns=columns, lines=lines), times=times)


def _windows(readings: Mapping[str, Sequence[Reading]], trial: Trial) -> list[Window]:
    """A window for each hit, from where the target drifts freely until it no longer does; none on several clocks.

    None either where there is one hit, and nobody's hand is seen.
    """
    spans = [span(f) for f in trial.files.values()]
    known = [s for s in spans if s is not None]
    if len(known) < len(spans) or max(s[0] for s in known) >= min(s[1] for s in known):
        return []
    bodies = _tracks(readings, trial, lambda r: r.thing == "target" and r.quantity == "position")
    sensors = _tracks(readings, trial, lambda r: r.quantity == "force" or r.thing == "wrist")
    if not bodies or not sensors:
        return []
    target = max(bodies, key=lambda t: float(np.ptp(t.value)))
    pulses = _pulses(max(sensors, key=_clearness))
    if not pulses:
        return []
    touching = np.interp([a for a, _ in pulses], target.time, target.value)
    forward = 1.0 if float(np.median(touching)) > float(np.median(target.value)) else -1.0
    target = Track(target.time, forward * target.value)
    hits = _by_return(target, pulses)
    edges = [target.time[0], *(_furthest(target, a[1], b[0]) for a, b in itertools.pairwise(hits))]
    edges.append(target.time[-1])
    windows = []
    for (first, last), low, high in zip(hits, edges, edges[1:], strict=False):
        let_go, caught = straight(target, first, low, back=True), straight(target, last, high)
        windows.append((let_go + BY_HAND * (first - let_go), caught - BY_HAND * (caught - last)))
    if len(windows) == 1:
        pushed, stopped = _by_hand(target, hits[0])
        window = (windows[0][0] if pushed else edges[0], windows[0][1] if stopped else edges[-1])
        return [window] if pushed or stopped else []
    return windows


def _by_hand(target: Track, hit: Window) -> tuple[bool, bool]:
    """Whether a target rests, or hardly moves, at the recording's beginning and at its end."""
    first, last = hit
    begin, end = float(target.time[0]), float(target.time[-1])
    before, after = first - begin, end - last
    comes, begun = _speed(target, first - 0.2 * before, first), _speed(target, begin, begin + 0.1 * before)
    leaves, ended = _speed(target, last, last + 0.2 * after), _speed(target, end - 0.1 * after, end)
    return abs(begun) < HELD * abs(comes), MOVES * abs(comes) < abs(leaves) and abs(ended) < HELD * abs(leaves)


def _speed(target: Track, first: float, last: float) -> float:
    """Of a line through a stretch; NaN, which is no share of anything, where it has too few readings."""
    inside = (target.time >= first) & (target.time <= last)
    if inside.sum() < FEWEST:
        return float("nan")
    return float(np.polyfit(target.time[inside] - first, target.value[inside], 1)[0])


def _tracks(readings: Mapping[str, Sequence[Reading]], trial: Trial, meant: Callable[[Reading], bool]) -> list[Track]:
    found = [
        track(trial.files[stream], reading.column)
        for stream, own in readings.items()
        if stream in trial.files
        for reading in own
        if not reading.command and meant(reading)
    ]
    return [t for t in found if t is not None and len(t.value) >= 4 * FEWEST]


def _away(own: Track) -> Floats:
    return np.abs(own.value - np.median(own.value))


def _clearness(own: Track) -> float:
    """The hardest push over the usual distance from rest."""
    away = _away(own)
    usual = float(np.quantile(away, 0.75))
    return float(away.max()) / usual if usual > 0.0 else 0.0


def _pulses(own: Track) -> list[Window]:
    """When a sensor is pushed."""
    away = _away(own)
    out = np.flatnonzero(away > max(CLEAR * estimate_noise(own.value), PUSHED * float(away.max())))
    if not len(out):
        return []
    ends = np.flatnonzero(np.diff(out) > 1)
    firsts, lasts = out[np.r_[0, ends + 1]], out[np.r_[ends, len(out) - 1]]
    return [(float(own.time[a]), float(own.time[b])) for a, b in zip(firsts, lasts, strict=True) if b > a]


def _by_return(target: Track, pulses: Sequence[Window]) -> list[Window]:
    """Pulses between which the target has not come anew as one hit: it bounced on the spring."""
    clear = 2 * CLEAR * estimate_noise(target.value)
    hits = [pulses[0]]
    for first, last in pulses[1:]:
        left, comes = np.interp([hits[-1][1], first], target.time, target.value)
        low = float(np.interp(_furthest(target, hits[-1][1], first), target.time, target.value))
        if low < min(left, comes) - clear:
            hits.append((first, last))
        else:
            hits[-1] = (hits[-1][0], last)
    return hits


def _furthest(target: Track, first: float, last: float) -> float:
    """When the target is furthest back between two times."""
    inside = np.flatnonzero((target.time >= first) & (target.time <= last))
    return float(target.time[inside[np.argmin(target.value[inside])]]) if len(inside) else first
