"""What a study holds, and what is odd about it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from spacerobot.recordings.beliefs import beliefs_of
from spacerobot.recordings.lacking import WRIST, lacks
from spacerobot.recordings.ranges import Limits, Range, Ranges, strangers
from spacerobot.recordings.recording import Recording, load_trial
from spacerobot.recordings.series import Series, estimate_noise
from spacerobot.recordings.study import Study
from spacerobot.simulation.rig import DEFAULTS
from spacerobot.support.errors import InputError

Ask = Callable[[Recording], Iterable[InputError]]
"""What somebody else finds wrong with a trial that can be read."""

LINEAR = 0.05
"""Zero of a joint that turns [rad] up to which its torque is linear in it, to 1.3 ‰: a sine's square term."""

IDLE = (".ratio", ".kp", ".kv")
"""Values of a joint that a study may state and that nothing simulates."""


def check_study(
    study: Study,
    limits: Mapping[str, Limits] | None = None,
    ask: Ask = lambda recording: (),
    report: Callable[[], object] = lambda: None,
) -> dict[str, Any]:
    """Trials, channels, ranges, rates, gaps, warnings and errors of a study, ready for JSON.

    A trial that cannot be read is listed with its error; the others are still checked. One recording at a time is in
    memory.

    Args:
        study: the study.
        limits: joint -> what its URDF says, where the robot was loaded.
        ask: asked of each recording what else is wrong with it.
        report: told of every trial that was read.
    """
    seen = Ranges(study, limits or {})
    trials: list[dict[str, Any]] = []
    errors: list[str] = []
    warnings: dict[str, tuple[str, int]] = {}
    for trial in study.trials:
        entry: dict[str, Any] = {
            "id": trial.id,
            "condition": study.condition(trial),
            "overrides": dict(trial.overrides),
        }
        try:
            recording = load_trial(study.streams, study.root, trial)
        except InputError as error:
            errors.append(f"trial {trial.id}: {error}")
            entry |= {"error": str(error), "channels": [], "notes": []}
        else:
            entry |= {"channels": [_channel(s) for s in recording.values()], "notes": list(recording.notes)}
            for key, text in _remarks(study, recording):
                first, count = warnings.get(key, (text, 0))
                warnings[key] = first, count + 1
            for refusal in ask(recording):
                errors.append(str(refusal))
                entry["error"] = str(refusal)
            seen.add(recording)
        trials.append(entry)
        report()
    spans = seen.found()
    try:
        digest = study.input_hash
    except InputError as error:
        digest = None
        errors.append(str(error))
    return {
        "study": str(study.path),
        "title": study.title,
        "draft": lacks(study) if study.draft else None,
        "data": str(study.root),
        "input_hash": digest,
        "baseline": {
            "robot": study.baseline.robot,
            "base": study.baseline.base,
            "joints": study.baseline.joints,
            "values": dict(study.baseline.values),
            "unknown": sorted(study.baseline.unknown),
            "sigma": dict(study.sigma),
            "scatter": dict(study.scatter),
        },
        "conditions": {name: [t.id for t in members] for name, members in study.conditions().items()},
        "trials": trials,
        "ranges": [asdict(r) for r in spans],
        "warnings": [
            *_believed(study),
            *_far_zeros(study, limits or {}),
            *strangers(study.channels(), limits or {}),
            *(r.warning for r in spans if r.warning),
            *_noiseless(study, spans),
            *_once(warnings),
        ],
        "errors": list(dict.fromkeys(errors)),
    }


def _channel(series: Series) -> dict[str, Any]:
    step = np.diff(series.time)
    return {
        "name": series.name,
        "stream": series.stream,
        "clock": series.clock,
        "unit": series.unit,
        "use": series.use,
        "samples": len(series),
        "missing": int((~series.valid).sum()),
        "rate_hz": series.rate,
        "start_s": float(series.time[0]),
        "end_s": float(series.time[-1]),
        "longest_gap_s": float(step.max()) if len(step) else None,
        "sigma": series.sigma,
        "sigma_stated": series.sigma_stated,
    }


def _believed(study: Study) -> list[str]:
    """Warnings about the baseline as a whole."""
    found: list[str] = []
    channels = study.channels()
    if any(c.startswith(("wrist.", "contact.")) for c in channels):
        known = {name for trial in study.trials for name in study.values(trial)}
        absent = [name for name in WRIST if name not in known]
        if absent:
            found.append(f"not stated, so unknown and fitted: {', '.join(absent)}")
    if len(study.conditions()) == 1 and len(study.trials) > 1:
        found.append("all trials share one condition: nothing can be held out by condition")
    if idle := _idle(study):
        found.append(f"stated, but no model reads it yet: {', '.join(idle)}")
    if "wrist.stiffness" in {*study.values(), *study.baseline.unknown}:
        found += beliefs_of(study, DEFAULTS).words()
    own = [s.name for s in study.streams.values() if s.own_clock]
    if own:
        found.append(f"streams on a clock of their own, whose offset is fitted: {', '.join(own)}")
    loose = [c for c in channels if c.startswith("aux.")]
    if loose:
        found.append(f"channels that no balance uses: {', '.join(loose[:12])}{', ...' if len(loose) > 12 else ''}")
    return found


def _far_zeros(study: Study, limits: Mapping[str, Limits]) -> list[str]:
    """A warning for zeros of encoders of joints that turn, doubted by more than a line is good for."""
    values = study.values()
    sizes = {**{n: share * abs(values.get(n, 0.0)) for n, share in study.sigma.items()}, **study.absolute}
    far = [
        f"{name} (sigma {size:.2g} rad)"
        for name, size in sizes.items()
        if name.startswith("joint.") and name.endswith(".zero") and size > LINEAR
        if not limits.get(name.split(".")[1], Limits()).slides
    ]
    if not far:
        return []
    linear = f"torques are taken as linear in a zero, good to {LINEAR:g} rad"
    return [f"{linear}; state it nearer, or what was found as the belief of a second run: {', '.join(far)}"]


def _idle(study: Study) -> list[str]:
    """Values that are stated, or whose sigma is, and that no model of this study reads."""
    stated = {*study.baseline.values, *study.sigma, *study.absolute}
    idle = {n for n in stated if n.startswith("joint.") and n.endswith(IDLE)}
    if any(c == "wrist.x" or c == "target.x" for c in study.channels()):
        shape = (".radius", ".length", ".width", ".height")  # drawn
        idle |= {n for n in stated if n.startswith(("wrist.", "contact.")) and n not in DEFAULTS}
        idle |= {n for n in stated if n.startswith("joint.") and n.endswith(".friction")}
        idle |= {n for n in study.absolute if n.startswith("target.") and n not in DEFAULTS and not n.endswith(shape)}
    return sorted(idle)


def _noiseless(study: Study, spans: Sequence[Range]) -> list[str]:
    """One warning that lists the measured channels whose sigma the study leaves open."""
    measured = {c.name for s in study.streams.values() if s.kind == "samples" for c in s.channels if c.use == "output"}
    open_ = [r for r in spans if r.name in measured and not r.sigma_stated and math.isfinite(r.sigma)]
    open_ = [r for r in open_ if not r.name.startswith("aux.") and not r.name.endswith(".reference")]
    if not open_:
        return []
    listed = ", ".join(f"{r.name} ({r.sigma:.2g} {r.unit})" for r in open_[:6])
    more = f" and {len(open_) - 6} more" if len(open_) > 6 else ""
    return [f"no sigma stated, so the noise is estimated: {listed}{more}"]


def _once(warnings: Mapping[str, tuple[str, int]]) -> list[str]:
    """Each warning about a channel once, with the numbers of its first trial and how many trials have it."""
    return [text + (f" (and {count - 1} trials more)" if count > 1 else "") for text, count in warnings.values()]


def _remarks(study: Study, recording: Recording) -> list[tuple[str, str]]:
    """Warnings about channels, each with what tells it from others."""
    found: list[tuple[str, str]] = []
    trial = recording.trial.id
    found += _never_together(recording)
    for series in recording.values():
        if series.use == "input" or series.name.startswith("aux.") or series.name.endswith(".reference"):
            continue
        if study.streams[series.stream].kind == "events":
            continue
        if not series.sigma_stated:
            continue
        noise = estimate_noise(series.value)
        if noise > 3 * series.sigma or (0 < noise < series.sigma / 3):
            text = (
                f"{series.name}: sigma is stated as {series.sigma:.2g} {series.unit}, readings scatter by {noise:.2g}"
            )
            found.append((f"{series.name} sigma", f"{text} in trial {trial}: they differ more than threefold"))
        missing = float((~series.valid).mean())
        if missing > 0.2:
            found.append(
                (f"{series.name} missing {trial}", f"{series.name}: missing in {missing:.0%} of trial {trial}")
            )
    return found


def _never_together(recording: Recording) -> list[tuple[str, str]]:
    """A warning for streams that are said to share a clock and never ran at the same time by it."""
    spans: dict[str, dict[str, tuple[float, float]]] = {}
    for series in recording.values():
        if len(series) > 1:
            spans.setdefault(series.clock, {})[series.stream] = float(series.time[0]), float(series.time[-1])
    found = []
    for clock in spans.values():
        for (one, (start, end)), (other, (from_, to)) in itertools.combinations(clock.items(), 2):
            if min(end, to) <= max(start, from_):
                said = f"{one} ({start:.6g} to {end:.6g} s) and {other} ({from_:.6g} to {to:.6g} s)"
                text = f'trial {recording.trial.id}: {said} share a clock and never run together: clock = "own"?'
                found.append((f"{one} {other} clock", text))
    return found
