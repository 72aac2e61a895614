"""The measured motion of one trial: who touches when, and where every coordinate is, smoothed."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from spacerobot.diagnosis.locate.driven import Driven, driven
from spacerobot.diagnosis.locate.laws import TARGET, WRIST, YAW, push
from spacerobot.diagnosis.locate.phases import Touches, phases_of, touches_in_force, touches_in_penetration
from spacerobot.diagnosis.locate.readings import NothingToBalance, Observers, Series, State, Track, observers, series_of
from spacerobot.diagnosis.locate.smoothing import Pieces, Smooth
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.mechanism import Mechanism

EDGE = 5e-3
"""A force this close [s] to a stretch of contact still drives the expected motion."""

SOFTEN = 4e-3
"""Width [s] of the running mean of the contact force where it serves as a regressor."""


class Motion:
    """What was measured in one trial.

    Attributes:
        trial, mechanism: whose, and its baseline (for geometry and readouts).
        series: valid samples by channel.
        observers: who measures which coordinate.
        start, end: of the stretch that all of them cover [s].
        force: the measured contact force, positive in compression, or None.
        touches, phases: when what.
        tracks: the channels smoothed.
    """

    def __init__(self, trial: TrialData, mechanism: Mechanism) -> None:
        self.trial = trial
        self.mechanism = mechanism
        self.series = series_of(trial)
        self.observers: Observers = observers(mechanism, self.series)
        moving = [self.series[c] for c in self.observers.rows]
        if not moving:
            raise NothingToBalance("no channel measures a coordinate of the model", where=f"trial {trial.id}")
        self.start = max(s.time[0] for s in moving)
        self.end = min(s.time[-1] for s in moving)
        self.step = max(s.step for s in moving)
        self._turned: dict[str, Smooth] = {}
        self.force = self._contact_force()
        self.touches = Touches(())
        if self.force is not None:
            self.touches = touches_in_force(self.force.time, self.force.value, self.force.sigma)
        self._driven = self._expected()
        self.tracks = {c: self._track(c) for c in self.observers.rows}
        if self.force is None and mechanism.contact is not None:
            self.touches = self._touches_by_depth()
        self.phases = phases_of(self.touches, self._turn(), self.start, self.end)

    def _contact_force(self) -> Series | None:
        for channel, readout in self.mechanism.readouts.items():
            if readout.kind == "force" and readout.of == "contact" and channel in self.series:
                found = self.series[channel]
                return Series(channel, found.time, readout.sign * found.value, found.sigma)
        return None

    def _expected(self) -> Driven:
        """What the model expects of the measured contact force."""
        if self.force is None or not self.touches.stretches:
            return driven(self.mechanism, np.array([self.start, self.end]), {})
        time = self.force.time
        pressed = np.where(self.touches.inside(time, EDGE), self.force.value, 0.0)
        return driven(self.mechanism, time, {n: by * pressed for n, by in push(self.mechanism, self.yaw, time).items()})

    def yaw(self, times: np.ndarray) -> np.ndarray:
        """Smoothed yaw, zero where it is not measured."""
        if YAW not in self.observers.solution:
            return np.zeros(times.shape)
        out = np.zeros(times.shape)
        for channel, factor in self.observers.solution[YAW].items():
            if channel not in self._turned:
                s = self.series[channel]
                self._turned[channel] = Smooth.through(s.time, s.value, s.sigma)
            out += factor * self._turned[channel].value(times)
        return out

    def _track(self, channel: str) -> Track:
        s = self.series[channel]
        rate = channel in self.observers.rates
        position, slope, bend = self._driven.along(self.observers.rows[channel])
        base, derivative = (slope, bend) if rate else (position, slope)
        time = self._driven.time
        cuts = (self.touches.first, self.touches.last) if self.touches.stretches else ()
        smooth = Pieces.through(s.time, s.value - np.interp(s.time, time, base), s.sigma, cuts)
        return Track(smooth, time, base, derivative, bend, rate)

    def _touches_by_depth(self) -> Touches:
        if not {WRIST, TARGET} <= set(self.observers.solution):
            return Touches(())
        time = np.linspace(self.start, self.end, 2000)
        b, a = self.state_of(TARGET, time), self.state_of(WRIST, time)
        return touches_in_penetration(time, b.d - a.d, np.hypot(a.d_error, b.d_error))

    def _turn(self) -> float | None:
        if not self.touches.stretches or TARGET not in self.observers.solution:
            return None
        time = np.linspace(self.touches.first, self.touches.last, 400)
        return float(time[int(np.argmax(self.state_of(TARGET, time).d))])

    def state_of(self, coordinate: str, times: np.ndarray) -> State:
        """Smoothed motion of a coordinate at ascending times, shape (N,)."""
        return self._sum([(x, self.tracks[c].at(times)) for c, x in self.observers.solution[coordinate].items()], times)

    def port_state(self, row: dict[str, float], times: np.ndarray) -> State:
        """Smoothed motion of a port with this row of coefficients at ascending times, shape (N,)."""
        return self._sum([(x, self.state_of(c, times)) for c, x in row.items() if x], times)

    @staticmethod
    def _sum(parts: list[tuple[float, State]], times: np.ndarray) -> State:
        zero = np.zeros(times.shape)
        d, v, dd, vv = zero.copy(), zero.copy(), zero.copy(), zero.copy()
        for x, s in parts:
            d += x * s.d
            v += x * s.v
            dd += (x * s.d_error) ** 2
            vv += (x * s.v_error) ** 2
        return State(times, d, v, np.sqrt(dd), np.sqrt(vv))

    @cached_property
    def soft_force(self) -> np.ndarray:
        """The contact force at its own samples, softened and zero out of contact, shape (T,) [N]."""
        assert self.force is not None  # asked only where it is measured
        n = min(max(1, round(SOFTEN / self.force.step)), self.force.time.size)
        pressed = np.where(self.touches.inside(self.force.time), self.force.value, 0.0)
        return np.convolve(pressed, np.full(n, 1.0 / n), "same")

    def pressing(self, times: np.ndarray) -> np.ndarray:
        """The softened contact force at any times [N]; zero where it is not measured."""
        if self.force is None:
            return np.zeros(times.shape)
        return np.asarray(np.interp(times, self.force.time, self.soft_force))

    def shaking(self, mechanism: Mechanism, coordinates: Sequence[str], mass: float) -> tuple[np.ndarray, np.ndarray]:
        """Times (T,) and the known load on some coordinates over a mass [m/s^2 or rad/s^2], shape (T,) each.

        The load is the contact force, softened, or else the recorded drives.
        """
        if self.force is not None:
            by = push(mechanism, self.yaw, self.force.time)
            sums = sum((by[c] for c in coordinates if c in by), np.zeros(self.force.time.shape))
            return self.force.time, sums * self.soft_force / mass
        for item in mechanism.inputs:
            factor = sum(mechanism.ports[item.port].get(c, 0.0) for c in coordinates) * item.gain
            if factor and item.channel in self.series:
                series = self.series[item.channel]
                return series.time, factor * series.value / mass
        return np.array([self.start, self.end]), np.zeros(2)
