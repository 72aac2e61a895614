"""One trial prepared for weak balances: test functions, the channels' weights, the motion, the contact force."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array

from spacerobot.diagnosis.data import TrialData
from spacerobot.diagnosis.locate.driven import Driven, driven
from spacerobot.diagnosis.locate.geometry import TARGET, YAW, push
from spacerobot.diagnosis.locate.integral import Integral, total
from spacerobot.diagnosis.locate.phases import (
    Touches,
    phases_of,
    touches_in_force,
    touches_in_penetration,
    windows_of,
)
from spacerobot.diagnosis.locate.readings import Observers, Series, State, Track, observers, series_of
from spacerobot.diagnosis.locate.samples import Grid
from spacerobot.diagnosis.locate.smoothing import Pieces, Smooth
from spacerobot.diagnosis.locate.windows import Splines
from spacerobot.effects.mechanism import Mechanism
from spacerobot.support.errors import InputError

SAMPLES_A_KNOT = 2.0
"""Knots of the test functions lie this many samples of the slowest position channel apart."""

MOST_PIECES = 300

JUMP = 5.0
"""Neighbouring force samples that differ by more than this many sigmas: a touch fell between them, who knows when."""

JUMPS = "|jumps"

EDGE = 5e-3
"""A force this close [s] to a stretch of contact still drives the expected motion."""

SOFTEN = 4e-3
"""Width [s] of the running mean of the contact force where it serves as a regressor."""


class WeakTrial:
    """The parts of a trial that do not depend on the values balanced with. I test functions, Q nodes.

    Attributes:
        trial, mechanism: whose, and its baseline (for geometry and readouts).
        series: valid samples by channel.
        observers: who measures which coordinate.
        touches, phases, windows: when what.
        force: the measured contact force, or None.
        nodes: Gauss nodes that the regressors live on, shape (Q,) [s].
    """

    def __init__(self, trial: TrialData, mechanism: Mechanism) -> None:
        self.trial = trial
        self.mechanism = mechanism
        self.series = series_of(trial)
        self.observers: Observers = observers(mechanism, self.series)
        moving = [self.series[c] for c in self.observers.rows]
        if not moving:
            raise InputError("no channel measures a coordinate of the model", where=f"trial {trial.id}")
        self.start = max(s.time[0] for s in moving)
        self.end = min(s.time[-1] for s in moving)
        self.spacing = max(SAMPLES_A_KNOT * max(s.step for s in moving), (self.end - self.start) / MOST_PIECES)
        self.smoothed = False
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
        windows = windows_of(self.touches, self.phases, self.spacing)
        if windows is None:
            raise InputError("a trial is too short for a balance", given=trial.id)
        self.windows = windows
        self.nodes, weight = windows.nodes()
        self._own = Grid.over(windows, self.nodes, weight)
        self._grids: dict[bytes, Grid] = {}
        self._integrals: dict[tuple[str, int], Integral] = {}

    # --- what was measured ---------------------------------------------------------------------------------------

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
        return driven(
            self.mechanism, time, {n: by * pressed for n, by in push(self.mechanism, self.yaw, time).items()}
        )

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
        if not {"wrist", TARGET} <= set(self.observers.solution):
            return Touches(())
        time = np.linspace(self.start, self.end, 2000)
        b, a = self.state_of(TARGET, time), self.state_of("wrist", time)
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
        n = max(1, round(SOFTEN / self.force.step))
        pressed = np.where(self.touches.inside(self.force.time), self.force.value, 0.0)
        return np.convolve(pressed, np.full(n, 1.0 / n), "same")

    def pressing(self, times: np.ndarray) -> np.ndarray:
        """The softened contact force at any times [N]; zero where it is not measured."""
        if self.force is None:
            return np.zeros(times.shape)
        return np.interp(times, self.force.time, self.soft_force)

    def without_noise(self) -> WeakTrial:
        """The same trial with its positions replaced by the smoothed ones."""
        other = copy(self)
        other.smoothed = True
        other._integrals = {}
        return other

    def pressed_windows(self) -> np.ndarray:
        """Test functions that lie in unbroken contact after the onset, shape (I,) bool."""
        keep = np.zeros(self.windows.count, dtype=bool)
        first = 0
        for part in self.windows.parts:
            if isinstance(part, Splines):
                half = 2.0 * part.spacing
                for start, end in self.touches.stretches:
                    begin = max(start, self.phases["onset"][1])
                    inside = (part.centres - half >= begin) & (part.centres + half <= end)
                    keep[first : first + part.count] |= inside
            first += part.count
        return keep

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

    # --- integrals -----------------------------------------------------------------------------------------------

    def grid(self, series: Series) -> Grid:
        """The grid of a channel's samples, shared by channels with the same times."""
        key = series.time.tobytes()
        if key not in self._grids:
            self._grids[key] = Grid.of(self.windows, series.time, self.spacing)
        return self._grids[key]

    def integral(self, order: int, at_nodes: np.ndarray) -> np.ndarray:
        """int phi^(order) b dt of a function given at `nodes`, shape (I,)."""
        return self._own.integral(order, at_nodes)

    def coordinate(self, name: str, order: int) -> Integral:
        """int phi^(order) q dt of a measured coordinate."""
        parts = [x * self._channel(c, order) for c, x in self.observers.solution[name].items()]
        return total(parts, self.windows.count)

    def _channel(self, channel: str, order: int) -> Integral:
        if (channel, order) not in self._integrals:
            self._integrals[channel, order] = self._new_channel(channel, order)
        return self._integrals[channel, order]

    def _new_channel(self, channel: str, order: int) -> Integral:
        series, track = self.series[channel], self.tracks[channel]
        if track.rate and order == 0:
            return Integral(self.integral(0, track.at(self.nodes).d))
        sign, k = (-1.0, order - 1) if track.rate else (1.0, order)
        weights = sign * self.grid(series).weights(k)
        remainder = track.smooth.value(series.time) if self.smoothed else track.remainder(series)
        value = weights @ remainder
        if order == 2 and self.force is not None:  # bent at every touch: taken where the force is sampled
            grid = self.grid(self.force)
            value = value + grid.integral(0, grid.read @ np.interp(self.force.time, track.known_time, track.known_bend))
        elif order < 2:
            value = value + sign * self.integral(k, np.interp(self.nodes, track.known_time, track.known))
        return Integral(value, {channel: weights})

    def contact_force(self, by: Callable[[np.ndarray], np.ndarray]) -> Integral:
        """int phi c F dt of the measured contact force, c given as a function of time.

        A jump between two samples may have come at any time between them: each is a source of noise of its own.
        """
        assert self.force is not None  # asked only where it is measured
        grid = self.grid(self.force)
        weights = grid.weights(0, by(grid.nodes))
        out = {self.force.channel: weights}
        time, value, sigma = self.force.time, self.force.value, self.force.sigma
        step = np.abs(np.diff(value))
        jumps = np.flatnonzero(step > JUMP * np.hypot(sigma[1:], sigma[:-1]))
        if jumps.size:
            middle = 0.5 * (time[jumps] + time[jumps + 1])
            size = by(middle) * step[jumps] * np.diff(time)[jumps] / np.sqrt(12.0)
            out[self.force.channel + JUMPS] = csr_array(self.windows.values(middle, 0).multiply(size))
        return Integral(weights @ value, out)

    def drive(self, channel: str, gain: float) -> Integral:
        """int phi gain u dt of a recorded drive."""
        series = self.series[channel]
        weights = gain * self.grid(series).weights(0)
        return Integral(weights @ series.value, {channel: weights})

    def modulated(self, row: dict[str, float], by_d: np.ndarray, by_v: np.ndarray) -> Integral:
        """int phi (a d + b v) dt of a port, a and b given at the nodes; the rate's derivative goes to phi and b.

        """
        slope = np.gradient(by_v, self.nodes)
        value = np.zeros(self.windows.count)
        weights: dict[str, csr_array] = {}
        for coordinate, x in row.items():
            for channel, factor in self.observers.solution[coordinate].items():
                series, track = self.series[channel], self.tracks[channel]
                if track.rate:  # its noise in these terms is small beside that of its own derivative
                    state = track.at(self.nodes)
                    value += x * factor * self.integral(0, by_d * state.d + by_v * state.v)
                    continue
                grid = self.grid(series)
                here = np.interp(grid.nodes, self.nodes, by_d - slope), np.interp(grid.nodes, self.nodes, by_v)
                matrix = x * factor * (grid.weights(0, here[0]) - grid.weights(1, here[1]))
                known = np.interp(self.nodes, track.known_time, track.known)
                known_rate = np.interp(self.nodes, track.known_time, track.known_rate)
                value += matrix @ (track.smooth.value(series.time) if self.smoothed else track.remainder(series))
                value += x * factor * self.integral(0, by_d * known + by_v * known_rate)
                weights[channel] = weights[channel] + matrix if channel in weights else matrix
        return Integral(value, weights)

    def sigma(self, channel: str, count: int) -> np.ndarray:
        """Standard deviations of the samples of a channel, or of a source of noise of its own, shape (count,)."""
        return np.ones(count) if channel.endswith(JUMPS) else self.series[channel].sigma
