"""One trial prepared for weak balances: test functions, and integrals that are linear in the samples."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy

import numpy as np
from scipy.sparse import csr_array

from spacerobot.diagnosis.locate.laws import push
from spacerobot.diagnosis.locate.motion import Motion
from spacerobot.diagnosis.locate.phases import windows_of
from spacerobot.diagnosis.locate.readings import NothingToBalance, Series, State
from spacerobot.diagnosis.locate.samples import Grid, Integral, total
from spacerobot.diagnosis.locate.windows import Splines
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.mechanism import Mechanism

SAMPLES_A_KNOT = 2.0
"""Knots of the test functions lie this many samples of the slowest position channel apart."""

MOST_PIECES = 300

JUMP = 5.0
"""Neighbouring force samples that differ by more than this many sigmas: a touch fell between them, who knows when."""

JUMPS = "|jumps"


class WeakTrial(Motion):
    """A trial's motion seen through test functions. I test functions, Q nodes.

    Nothing here depends on the values that a balance is made with, except the motion that a measured force is
    expected to cause, which cancels.

    Attributes:
        windows: the test functions.
        spacing: distance of their knots [s].
        nodes: Gauss nodes that the regressors live on, shape (Q,) [s].
        smoothed: whether positions are replaced by the smoothed ones.
    """

    def __init__(self, trial: TrialData, mechanism: Mechanism) -> None:
        super().__init__(trial, mechanism)
        self.spacing = max(SAMPLES_A_KNOT * self.step, (self.end - self.start) / MOST_PIECES)
        windows = windows_of(self.touches, self.phases, self.spacing)
        if windows is None:
            raise NothingToBalance("a trial is too short for a balance", given=trial.id)
        self.windows = windows
        self.smoothed = False
        self.nodes, weight = windows.nodes()
        self._own = Grid.over(windows, self.nodes, weight)
        self._states: dict[str, State] = {}
        self._grids: dict[tuple[bytes, bool], Grid] = {}
        self._integrals: dict[tuple[str, int], Integral] = {}
        self._pushes: dict[tuple[str | None, float, float], Integral] = {}

    def state_of(self, coordinate: str, times: np.ndarray) -> State:
        """Smoothed motion of a coordinate at ascending times, shape (N,); kept for the nodes."""
        if times is not getattr(self, "nodes", None):
            return super().state_of(coordinate, times)
        if coordinate not in self._states:
            self._states[coordinate] = super().state_of(coordinate, times)
        return self._states[coordinate]

    def without_noise(self) -> WeakTrial:
        """The same trial with its positions replaced by the smoothed ones; its integrals carry no weights."""
        other = copy(self)
        other.smoothed = True
        other._integrals = {}
        other._pushes = {}
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

    def grid(self, series: Series) -> Grid:
        """The grid of a channel's samples, shared by channels with the same times."""
        bent = series.channel in self.observers.rows
        key = series.time.tobytes(), bent
        if key not in self._grids:
            self._grids[key] = Grid.of(self.windows, series.time, self.spacing, bent=bent)
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
        return Integral(value, {} if self.smoothed else {channel: weights})

    def contact_force(self, mechanism: Mechanism, coordinate: str | None) -> Integral:
        """int phi c F dt of the measured contact force, c its push on a coordinate, or one.

        A jump between two samples may have come at any time between them: each is a source of noise of its own.
        """
        assert self.force is not None  # asked only where it is measured
        assert mechanism.contact is not None
        key = coordinate, mechanism.contact.ahead, mechanism.contact.lateral
        if key not in self._pushes:

            def by(times: np.ndarray) -> np.ndarray:
                return np.ones(times.shape) if coordinate is None else push(mechanism, self.yaw, times)[coordinate]

            self._pushes[key] = self._pushed(self.force, by)
        return self._pushes[key]

    def _pushed(self, force: Series, by: Callable[[np.ndarray], np.ndarray]) -> Integral:
        grid = self.grid(force)
        weights = grid.weights(0, by(grid.nodes))
        noise = {} if self.smoothed else {force.channel: weights, **self._jumps(force, by)}
        return Integral(weights @ force.value, noise)

    def _jumps(self, force: Series, by: Callable[[np.ndarray], np.ndarray]) -> dict[str, csr_array]:
        """The sources of noise that a force's jumps are: when between two samples each came, nobody read."""
        time, step = force.time, np.abs(np.diff(force.value))
        jumps = np.flatnonzero(step > JUMP * np.hypot(force.sigma[1:], force.sigma[:-1]))
        if not jumps.size:
            return {}
        middle = 0.5 * (time[jumps] + time[jumps + 1])
        size = by(middle) * step[jumps] * np.diff(time)[jumps] / np.sqrt(12.0)
        return {force.channel + JUMPS: csr_array(self.windows.values(middle, 0).multiply(size))}

    def drive(self, channel: str, gain: float) -> Integral:
        """int phi gain u dt of a recorded drive, whose jumps are no better known than a measured force's."""
        series = self.series[channel]
        weights = gain * self.grid(series).weights(0)
        jumps = self._jumps(series, lambda times: np.full(times.shape, gain))
        return Integral(weights @ series.value, {channel: weights, **jumps})

    def modulated(self, row: dict[str, float], by_d: np.ndarray, by_v: np.ndarray) -> Integral:
        """int phi (a d + b v) dt of a port, a and b given at the nodes; the rate's derivative goes to phi and b."""
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
