"""Each channel's range over all trials, beside what the baseline expects of it: millimetres for metres show here."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from spacerobot.recordings.channel import SLIDING, joint_of
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
        slides: whether it slides, rather than turns.
    """

    lower: float = -math.inf
    upper: float = math.inf
    velocity: float = math.inf
    effort: float = math.inf
    slides: bool = False

    def read_from(self, zero: float) -> Limits:
        """The same as an encoder reads them that shows `zero` [rad or m] where the URDF has its zero."""
        return replace(self, lower=self.lower + zero, upper=self.upper + zero)


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


class Ranges:
    """Gathers every channel's range, one recording after the other, none of which is kept.

    Args:
        study: for what it believes.
        limits: joint -> what its URDF says.
    """

    def __init__(self, study: Study, limits: Mapping[str, Limits]) -> None:
        values = study.values()
        self._study = study
        self._limits = {j: own.read_from(values.get(f"joint.{j}.zero", 0.0)) for j, own in limits.items()}
        self._seen: dict[str, _Seen] = {}
        self._pushed = self._force = 0.0

    def add(self, recording: Recording) -> None:
        """Take in a trial that could be read."""
        for name, series in recording.items():
            self._seen.setdefault(name, _Seen(self._unit(series), series.sigma_stated)).add(series)
        pushed, force = _reach(self._study.values(recording.trial), _speed(recording))
        self._pushed, self._force = max(self._pushed, pushed), max(self._force, force)

    def _unit(self, series: Series) -> str:
        """The channel's own; of a joint that slides lengths and forces, where the study states no unit."""
        slides = self._limits.get(joint_of(series.name), Limits()).slides
        return SLIDING.get(series.unit, series.unit) if slides else series.unit

    def found(self) -> list[Range]:
        """The ranges, in order of the study."""
        expected = {}
        if self._pushed:
            expected["wrist.x"] = (f"up to {self._pushed:.3g} m", self._pushed)
        if self._force:
            expected["contact.force"] = (f"up to {self._force:.3g} N", self._force)
        return [_range(name, seen, expected, self._limits) for name, seen in self._seen.items()]


@dataclass
class _Seen:
    """A channel so far."""

    unit: str
    sigma_stated: bool
    low: float = math.inf
    high: float = -math.inf
    rates: tuple[float, float] = (math.inf, -math.inf)
    sigmas: list[float] = field(default_factory=list)
    missing: float = 0.0

    def add(self, series: Series) -> None:
        self.low = min(self.low, float(np.nanmin(series.value)))
        self.high = max(self.high, float(np.nanmax(series.value)))
        rate = series.rate
        if not math.isnan(rate):  # of a single reading
            self.rates = min(self.rates[0], rate), max(self.rates[1], rate)
        self.sigmas.append(series.sigma)
        self.missing += float((~series.valid).mean())


def strangers(channels: Sequence[str], limits: Mapping[str, Limits]) -> list[str]:
    """One warning where channels name joints that the robot lacks; none where no robot was loaded."""
    named = dict.fromkeys(c.split(".")[1] for c in channels if c.startswith("joint."))
    absent = [j for j in named if limits and j not in limits]
    return [f"the robot has no joint {', '.join(absent)}; it has {', '.join(limits)}"] if absent else []


def _range(name: str, seen: _Seen, expected: Mapping[str, tuple[str, float]], limits: Mapping[str, Limits]) -> Range:
    belief, warning = "", ""
    largest = max(abs(seen.low), abs(seen.high))
    if name in expected:
        belief, size = expected[name]
        ratio = largest / size
        if not 1 / ODD < ratio < ODD:
            warning = f"{name} reaches {largest:.3g} {seen.unit}, the baseline expects {belief}: is its unit right?"
    elif name.startswith("joint."):
        belief, warning = _joint(name, seen.low, seen.high, seen.unit, limits)
    trials = len(seen.sigmas)
    return Range(
        name,
        seen.unit,
        seen.low,
        seen.high,
        seen.rates if math.isfinite(seen.rates[0]) else (math.nan, math.nan),
        float(np.median(seen.sigmas)),
        seen.sigma_stated,
        trials,
        seen.missing / trials,
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


def _reach(values: Mapping[str, float], speed: float | None) -> tuple[float, float]:
    """How far a target at this speed pushes the believed wrist in [m], and its contact force [N]; 0 where unknown.

    A mass m at speed v pushes a spring k in by v sqrt(m / k), against a slider of mass m_w its contact k_c reaches
    v sqrt(k_c m m_w / (m + m_w)).
    """
    mass, k = values.get("target.mass"), values.get("wrist.stiffness")
    if mass is None or k is None or speed is None or k <= 0:
        return 0.0, 0.0
    slider, contact = values.get("wrist.mass"), values.get("contact.stiffness")
    force = 0.0
    if slider is not None and contact is not None:
        force = speed * math.sqrt(contact * mass * slider / (mass + slider))
    return speed * math.sqrt(mass / k), force


def _speed(recording: Recording) -> float | None:
    """The target's speed over the first tenth of its record, m/s."""
    if "target.x" not in recording:
        return None
    time, value = recording["target.x"].good()
    few = max(3, len(time) // 10)
    if len(time) < few or not np.ptp(time[:few]) > 0:
        return None
    away = time[:few] - time[:few].mean()
    return abs(float(away @ value[:few]) / float(away @ away))
