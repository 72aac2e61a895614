"""Along and about which axes a free body moves, as far as its recordings show: in the plane, or in space."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spacerobot.effects.plane import PLACES, SPINS
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial

TINY = np.finfo(float).tiny


class Axis:
    """One coordinate of a free body: what it is called, which channels show it, which force drives it."""

    def __init__(self, name: str, group: str, letter: str, sign: float, angular: bool = False) -> None:
        """`group` is the channels' first word; `letter` x, y, z or yaw; the coordinate grows along sign * axis."""
        self.name, self.sign, self.angular = name, sign, angular
        self.position: tuple[str, ...] = (f"{group}.position.{letter}", f"{group}.{letter}")
        self.velocity: tuple[str, ...] = (f"{group}.velocity.{letter}",)
        if angular:
            self.position, self.velocity = (f"{group}.yaw",), (f"{group}.velocity.yaw", f"{group}.angular_velocity.z")
        self.force = f"{group}.torque.yaw" if angular else f"{group}.force.{letter}"

    def shown(self, channels: Sequence[str]) -> list[tuple[str, str]]:
        """(channel, kind) among these."""
        return [(c, "position") for c in self.position if c in channels] + [
            (c, "velocity") for c in self.velocity if c in channels
        ]


class Spin(Axis):
    """How a body in flight turns about one of the axes of its places."""

    def __init__(self, name: str, group: str, letter: str, sign: float) -> None:
        """As an axis; of turning about the vertical the angle may be logged too."""
        super().__init__(name, group, letter, sign, angular=True)
        if letter != "z":
            self.position, self.velocity = (), (f"{group}.angular_velocity.{letter}",)
            self.force = f"{group}.torque.{letter}"


LETTERS = "xyz"


def directions_of(study: Study) -> tuple[int, int]:
    """Which world axes the approach and gravity follow; z is up where nothing falls."""
    gravity = np.array(study.baseline.gravity)
    along = int(np.argmax(np.abs(study.baseline.approach)))
    return along, int(np.argmax(np.abs(gravity))) if gravity.any() else 2


def _along(study: Study) -> tuple[tuple[int, float], ...]:
    """World axis and sign of each place that a body may have: along the approach, across it, and the third."""
    along, up = directions_of(study)
    across, *last = (i for i in range(3) if i not in (along, up))
    third = last[0] if last else up
    return (along, float(np.sign(study.baseline.approach[along]))), (across, 1.0), (third, 1.0)


def axes_of(study: Study, group: str, flies: bool = False) -> list[Axis]:
    """The coordinates that a body of this study may have: along the approach, across it, and about the vertical.

    One that flies moves in the third direction too.
    """
    along, up = directions_of(study)
    count = 3 if flies else 1 if along == up else 2
    places = zip(PLACES, _along(study), strict=True)
    found = [Axis(name, group, LETTERS[axis], sign) for name, (axis, sign) in list(places)[:count]]
    return found if along == up else [*found, Axis(SPINS[2], group, "yaw", 1.0, angular=True)]


STEADY = 0.2
"""Share of the largest spin of a flight by which a steady one changes in it: a ball's, that the air slows. That of a
body that tumbles goes from one axis to the next."""


def spins_of(study: Study, trials: Sequence[Trial], group: str) -> Sequence[Axis]:
    """How a body that flies turns about the axes of its places, as far as that is logged and steady."""
    along = _along(study)
    # of left-handed places the spins are turned round
    hand = float(np.linalg.det([sign * np.eye(3)[axis] for axis, sign in along]))
    found = [Spin(n, group, LETTERS[axis], hand * sign) for n, (axis, sign) in zip(SPINS, along, strict=True)]
    every = [study.recording(t) for t in trials]
    told = [a for a in found if all(a.shown(sorted(r)) for r in every)]
    spins = [[_rates(r, a) for a in told] for r in every]
    return told if told and all(map(_steady, spins)) else []


def _rates(recording: Recording, axis: Axis) -> np.ndarray:
    """How fast it turns about an axis, as logged or as its angle changes, shape (T,) [rad/s]."""
    channel, kind = axis.shown(sorted(recording))[-1]
    time, value = recording[channel].good()
    return value if kind == "velocity" else np.gradient(np.unwrap(value), time)


def _steady(spins: Sequence[np.ndarray]) -> bool:
    """Whether the spins of one flight, shape (T,) each, stay what they are."""
    halves = [[half.mean() for half in np.array_split(spin, 2)] for spin in spins]
    return bool(max(abs(a - b) for a, b in halves) <= STEADY * max(np.abs(halves).max(), TINY))


PARTS = (4, 16, 64)
"""Into how many stretches a track is cut to read its curvature; between bounces only short ones fall freely."""

LEAST = 5
"""Readings that a stretch has at least."""

FREELY = 0.5
"""Share of gravity with which a body moves that nothing carries: a table leaves none of it, free flight all."""


def flies(study: Study, trials: Sequence[Trial], group: str) -> bool:
    """Whether nothing carries a tracked body: it falls freely, is thrust up and down, or floats where nothing falls."""
    along, up = directions_of(study)
    gravity = float(study.baseline.gravity[up])
    upright = Axis("target.z", group, LETTERS[up], 1.0)
    if along == up:
        aside = [Axis("target.y", group, LETTERS[i], 1.0) for i in range(3) if i != up]
        return all(all(a.shown(sorted(study.recording(t))) for a in aside) for t in trials)
    tracks: list[tuple[np.ndarray, np.ndarray, int]] = []
    for trial in trials:
        recording = study.recording(trial)
        shown = {kind: c for c, kind in upright.shown(sorted(recording))}
        if not shown:
            return False
        if not gravity or upright.force in recording:
            return True
        kind = "position" if "position" in shown else "velocity"
        tracks.append((*recording[shown[kind]].good(), 2 if kind == "position" else 1))
    return any(_falling([_accelerations(*t, parts) for t in tracks], gravity) for parts in PARTS)


def _accelerations(time: np.ndarray, value: np.ndarray, degree: int, parts: int) -> list[float]:
    """Of a track of places (degree 2) or rates (1), over so many stretches of it or the whole of a short one."""
    out = []
    for part in np.array_split(np.arange(time.size), parts if time.size >= LEAST * parts else 1):
        if part.size > degree + 1:
            leading = np.polynomial.Polynomial.fit(time[part], value[part], degree).convert().coef[-1]
            out.append(float(degree * leading))
    return out


def _falling(accelerations: Sequence[Sequence[float]], gravity: float) -> bool:
    """Whether most stretches fall as freely as that, and their scatter does not make it chance."""
    every = np.concatenate([np.array(a) for a in accelerations]) / gravity
    if not every.size:
        return False
    middle = float(np.median(every))
    error = float(np.median(np.abs(every - middle))) / every.size**0.5
    return bool(middle - CLEAR * error > FREELY)


CLEAR = 2.0
"""Standard errors of a median by which it must lie beyond what it is compared with."""
