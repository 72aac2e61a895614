"""Each channel's range over all trials, beside what the baseline expects of it: millimetres for metres show here."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.recordings.recording import Recording
from spacerobot.recordings.series import Series
from spacerobot.recordings.study import Study

ODD = 30.0
"""Ratio from which a reading and its belief cannot both be right: halfway between right and off by a thousand
(millimetres) on a logarithmic scale, and below the 57 of degrees for radians."""

TURNS = 4 * math.pi
"""A joint angle beyond two turns is in degrees where its robot states no limits."""


@dataclass(frozen=True)
class Limits:
    """What a URDF says of a joint.

    Attributes:
        lower, upper: rad or m, infinite where it says nothing.
        velocity: rad/s or m/s.
        effort: N m or N.
    """

    lower: float = -math.inf
    upper: float = math.inf
    velocity: float = math.inf
    effort: float = math.inf


@dataclass(frozen=True)
class Range:
    """A channel over all trials.

    Attributes:
        name: canonical.
        unit: SI.
        low, high: of all valid readings.
        rate: median samples per second, lowest and highest of the trials, Hz.
        sigma: median over the trials, SI; NaN for events.
        sigma_stated: whether the study states it.
        trials: how many have it.
        missing: share of samples without a reading.
        belief: what the baseline expects, in words with its number; "" where it says nothing.
        warning: why readings and belief do not go together; "" where they do.
    """

    name: str
    unit: str
    low: float
    high: float
    rate: tuple[float, float]
    sigma: float
    sigma_stated: bool
    trials: int
    missing: float
    belief: str = ""
    warning: str = ""


def ranges(study: Study, recordings: Sequence[Recording], limits: Mapping[str, Limits]) -> list[Range]:
    """Every channel's range, in order of the study.

    Args:
        study: for what it believes.
        recordings: of the trials that can be read.
        limits: joint -> what its URDF says.
    """
    found: dict[str, list[Series]] = {}
    for recording in recordings:
        for name, series in recording.items():
            found.setdefault(name, []).append(series)
    expected = _expected(study, recordings)
    return [_range(name, several, expected, limits) for name, several in found.items()]


def strangers(channels: Sequence[str], limits: Mapping[str, Limits]) -> list[str]:
    """One warning where channels name joints that the robot lacks; none where no robot was loaded."""
    named = dict.fromkeys(c.split(".")[1] for c in channels if c.startswith("joint."))
    absent = [j for j in named if limits and j not in limits]
    return [f"the robot has no joint {', '.join(absent)}; it has {', '.join(limits)}"] if absent else []


def _range(
    name: str, several: list[Series], expected: Mapping[str, tuple[str, float]], limits: Mapping[str, Limits]
) -> Range:
    low = min(float(np.nanmin(s.value)) for s in several)
    high = max(float(np.nanmax(s.value)) for s in several)
    rates = [s.rate for s in several]
    unit = several[0].unit
    belief, warning = "", ""
    largest = max(abs(low), abs(high))
    if name in expected:
        belief, size = expected[name]
        ratio = largest / size if size > 0 else 1.0
        if not 1 / ODD < ratio < ODD:
            warning = f"{name} reaches {largest:.3g} {unit}, the baseline expects {belief}: is its unit right?"
    elif name.startswith("joint."):
        belief, warning = _joint(name, low, high, unit, limits)
    return Range(
        name,
        unit,
        low,
        high,
        (min(rates), max(rates)),
        float(np.median([s.sigma for s in several])),
        several[0].sigma_stated,
        len(several),
        float(np.mean([(~s.valid).mean() for s in several])),
        belief,
        warning,
    )


def _joint(name: str, low: float, high: float, unit: str, limits: Mapping[str, Limits]) -> tuple[str, str]:
    joint, _, quantity = name.removeprefix("joint.").rpartition(".")
    largest = max(abs(low), abs(high))
    stated = limits.get(joint, Limits())
    if quantity in ("position", "reference"):
        if math.isfinite(stated.lower) and math.isfinite(stated.upper):
            belief = f"{stated.lower:.3g} to {stated.upper:.3g} {unit} (URDF)"
            slack = 0.02 * (stated.upper - stated.lower)  # encoders and stops agree to a few per cent
            if low < stated.lower - slack or high > stated.upper + slack:
                return belief, f"{name} runs from {low:.3g} to {high:.3g} {unit}, its URDF allows {belief[:-7]}"
            return belief, ""
        if unit == "rad" and largest > TURNS:
            return "", f"{name} reaches {largest:.3g} rad, {largest / (2 * math.pi):.0f} turns: are these degrees?"
        return "", ""
    bound = {"velocity": stated.velocity, "torque": stated.effort}.get(quantity, math.inf)
    if not (math.isfinite(bound) and bound > 0):
        return "", ""
    belief = f"up to {bound:.3g} {unit} (URDF)"
    return belief, f"{name} reaches {largest:.3g} {unit}, its URDF allows {bound:.3g}" if largest > ODD * bound else ""


def _expected(study: Study, recordings: Sequence[Recording]) -> dict[str, tuple[str, float]]:
    """Channel -> the size that the believed wrist gives it, in words and SI.

    A mass m at speed v pushes a spring k in by v sqrt(m / k), against a slider of mass m_w its contact k_c reaches
    v sqrt(k_c m m_w / (m + m_w)).
    """
    pushed, forces = [], []
    for recording in recordings:
        values = study.values(recording.trial)
        mass, k = values.get("target.mass"), values.get("wrist.stiffness")
        speed = _speed(recording)
        if mass is None or k is None or speed is None or k <= 0:
            continue
        pushed.append(speed * math.sqrt(mass / k))
        slider, contact = values.get("wrist.mass"), values.get("contact.stiffness")
        if slider is not None and contact is not None:
            forces.append(speed * math.sqrt(contact * mass * slider / (mass + slider)))
    found = {}
    if pushed:
        found["wrist.x"] = (f"up to {max(pushed):.3g} m", max(pushed))
    if forces:
        found["contact.force"] = (f"up to {max(forces):.3g} N", max(forces))
    return found


def _speed(recording: Recording) -> float | None:
    """The target's speed over the first tenth of its record, m/s."""
    if "target.x" not in recording:
        return None
    time, value = recording["target.x"].good()
    few = max(3, len(time) // 10)
    if len(time) < few or not np.ptp(time[:few]) > 0:
        return None
    return abs(float(np.polyfit(time[:few] - time[0], value[:few], 1)[0]))
