"""A body that nothing holds: it falls, or glides, or is pushed by recorded forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from spacerobot.diagnosis.forward.base import ChannelOverlay, ForwardModel, TrialOverlay, Value, channels_of, overlaid
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.series import Series
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.support.errors import InputError

AXES = ("x", "y", "z", "yaw")

START = 0.2
"""Share of a stretch, from its beginning, that its start is read from; five readings at least."""

RESTART = 5.0
"""Seconds after which a body under recorded forces starts anew: its errors are integrated twice."""


@dataclass(frozen=True, eq=False)
class FreeBody(ForwardModel):
    """m a = m g + recorded force, axis by axis; a turn goes on as it is.

    Attributes:
        study: whose baseline it is.
    """

    kind = "a free body under gravity and its recorded forces"

    study: Study

    @classmethod
    def applies(cls, study: Study) -> bool:
        """A free body's position or yaw is tracked, and the baseline has no contact."""
        shown = any(_position(axis) in channels_of(study, "output") for axis in AXES)
        no_contact = not any(n.startswith("contact.") for n in study.values()) and study.baseline.law != "none"
        events = any(s.kind == "events" for s in study.streams.values())
        return study.baseline.robot is None and shown and no_contact and not events

    @classmethod
    def of(cls, study: Study) -> Self:
        """The body as believed.

        Raises:
            InputError: it is pushed, and its mass is not stated.
        """
        for name in {_inertia(axis) for axis in AXES if _force(axis) in channels_of(study, "input")}:
            if any(study.value(name, t) is None for t in study.trials):
                raise InputError(f"a body under recorded forces needs its {name}", where=str(study.path))
        return cls(study)

    @property
    def values(self) -> tuple[Value, ...]:
        """Mass and gravity."""
        mass = self.study.value("body.mass")
        gravity = zip(AXES, self.study.baseline.gravity, strict=False)
        return (
            *(() if mass is None else (Value("body.mass", mass, "kg"),)),
            *(Value(f"gravity.{axis}", g, "m/s2") for axis, g in gravity if _position(axis) in self._shown),
        )

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What was taken for granted."""
        said = [
            f"Each start is the one that fits the first {100 * START:.0f} % of its stretch; air, friction and slopes "
            "are not part of the baseline."
        ]
        if any(_force(axis) in channels_of(self.study, "input") for axis in AXES):
            said.append(
                f"Under recorded forces any error is integrated twice: the simulation starts anew every {RESTART:g} s."
            )
        return tuple(said)

    def simulate(self, trial: Trial) -> TrialOverlay:
        """One trial, axis by axis."""
        recording = self.study.recording(trial)
        channels: list[ChannelOverlay] = []
        for axis, gravity in zip(AXES, (*self.study.baseline.gravity, 0.0), strict=True):
            track = recording.series.get(_position(axis))
            rates = [recording.series[n] for n in _rates(axis) if n in recording]
            if (track is None and not rates) or (axis == "yaw" and _turned(recording)):
                continue
            channels += self._along(recording, trial, axis, gravity, track, rates)
        return TrialOverlay(trial.id, self.study.condition(trial), tuple(channels))

    def _along(
        self,
        recording: Recording,
        trial: Trial,
        axis: str,
        gravity: float,
        track: Series | None,
        rates: Sequence[Series],
    ) -> list[ChannelOverlay]:
        drive = recording.series.get(_force(axis))
        first = track if track is not None else rates[0]
        starts = first.time[:1] if drive is None else np.arange(first.time[0], first.time[-1], RESTART)
        out = {s.name: np.full(len(s), np.nan) for s in (track, *rates) if s is not None}
        for begin, end in zip(starts, np.append(starts[1:], np.inf), strict=True):
            pushed = _Pushed(begin, gravity, drive, self.study.value(_inertia(axis), trial) or 1.0)
            found = None if track is None else _start(track, begin, end, pushed)
            for series in (track, *rates):
                if series is None:
                    continue
                inside = (series.time >= begin) & (series.time < end)
                speed, place = pushed(series.time[inside])
                x, v = found if found is not None else (0.0, _first_rate(series, begin, end, pushed))
                is_track = series is track
                out[series.name][inside] = x + v * (series.time[inside] - begin) + place if is_track else v + speed
        restarts = None if drive is None else starts
        return [overlaid(s, out[s.name], restarts=restarts) for s in (track, *rates) if s is not None]

    @property
    def _shown(self) -> set[str]:
        return channels_of(self.study, "output")


class _Pushed:
    """Speed and path that gravity and a recorded force give a body from rest, from `begin` on."""

    def __init__(self, begin: float, gravity: float, drive: Series | None, mass: float) -> None:
        self._begin, self._gravity = begin, gravity
        self._time = self._speed = self._path = np.zeros(0)
        if drive is not None:
            time, force = drive.good()
            later = time[time > begin]
            self._time = np.concatenate([[begin], later])
            rate = np.interp(self._time, time, force) / mass
            step = np.diff(self._time)
            self._speed = np.concatenate([[0.0], np.cumsum(0.5 * step * (rate[1:] + rate[:-1]))])
            # exact for a force that is linear between its samples
            gained = self._speed[:-1] * step + step**2 * (2.0 * rate[:-1] + rate[1:]) / 6.0
            self._path = np.concatenate([[0.0], np.cumsum(gained)])

    def __call__(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        t = time - self._begin
        speed, path = self._gravity * t, 0.5 * self._gravity * t**2
        if self._time.size:
            speed = speed + np.interp(time, self._time, self._speed)
            path = path + np.interp(time, self._time, self._path)
        return speed, path


def _start(track: Series, begin: float, end: float, pushed: _Pushed) -> tuple[float, float]:
    """Position and rate at `begin` that fit the first readings of a stretch best."""
    time, value = track.good()
    near = (time >= begin) & (time < min(end, begin + START * (min(end, time[-1]) - begin)))
    if near.sum() < 5:
        near = (time >= begin) & (np.cumsum(time >= begin) <= 5)
    if near.sum() < 2:
        return (float(value[near][0]) if near.any() else float("nan")), 0.0
    _, path = pushed(time[near])
    slope, offset = np.polyfit(time[near] - begin, value[near] - path, 1)
    return float(offset), float(slope)


def _first_rate(series: Series, begin: float, end: float, pushed: _Pushed) -> float:
    """Rate at `begin` where only rates are recorded."""
    time, value = series.good()
    near = (time >= begin) & (time < min(end, begin + START * (min(end, time[-1]) - begin)))
    if not near.any():
        return float("nan")
    speed, _ = pushed(time[near])
    return float(np.mean(value[near] - speed))


def _turned(recording: Recording) -> bool:
    """Whether something else turns the body: a joint whose motion is an input."""
    return any(s.name.startswith("joint.") for s in recording.inputs())


def _position(axis: str) -> str:
    return "body.yaw" if axis == "yaw" else f"body.position.{axis}"


def _force(axis: str) -> str:
    return "body.torque.yaw" if axis == "yaw" else f"body.force.{axis}"


def _inertia(axis: str) -> str:
    return "body.yaw_inertia" if axis == "yaw" else "body.mass"


def _rates(axis: str) -> tuple[str, ...]:
    return ("body.velocity.yaw", "body.angular_velocity.z") if axis == "yaw" else (f"body.velocity.{axis}",)
