"""What a trial's channels say of a mechanism's coordinates: who measures what, and the motion smoothed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import erf

from spacerobot.diagnosis.locate.smoothing import BEYOND, Pieces
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.mechanism import Mechanism
from spacerobot.support.errors import InputError

NEARBY = 0.06
"""Seconds around a motion that stands clear of its noise that count as moving too."""


@dataclass(frozen=True, eq=False)
class Series:
    """Valid samples of one channel. T samples."""

    channel: str
    time: np.ndarray  # (T,) s
    value: np.ndarray  # (T,) SI
    sigma: np.ndarray  # (T,)

    @property
    def step(self) -> float:
        """Median distance of the samples [s]."""
        return float(np.median(np.diff(self.time))) if self.time.size > 1 else np.inf


class NothingToBalance(InputError):
    """A trial is too short for a balance, or none of its channels measures the model."""


LEAST = 8
"""Valid samples of a channel below which nothing can be seen in it."""


def series_of(trial: TrialData) -> dict[str, Series]:
    """Every channel of a trial with enough valid samples for a test function, in ascending time."""
    out = {}
    for name in trial.channels:
        time, value, weight = trial.channel(name)
        fresh = np.concatenate([[True], np.diff(time) > 0.0]) if time.size else np.zeros(0, dtype=bool)
        if fresh.sum() >= LEAST:
            out[name] = Series(name, time[fresh], value[fresh], 1.0 / weight[fresh])
    return out


@dataclass(frozen=True)
class Observers:
    """Which channels measure the coordinates.

    Attributes:
        rows: channel -> {coordinate: coefficient} of what it reads.
        rates: channels among them that read a rate.
        solution: coordinate -> {channel: coefficient}, for the coordinates that the channels determine.
    """

    rows: Mapping[str, Mapping[str, float]]
    rates: frozenset[str]
    solution: Mapping[str, Mapping[str, float]]


def observers(mechanism: Mechanism, channels: Mapping[str, Series]) -> Observers:
    """Coordinates from positions where there are any, from rates elsewhere (least squares on the readouts' rows)."""
    kinds: dict[str, dict[str, dict[str, float]]] = {"position": {}, "velocity": {}}
    for name in channels:
        readout = mechanism.readouts.get(name)
        if readout is not None and readout.kind in kinds and readout.of in mechanism.ports:
            row = {c: readout.sign * x for c, x in mechanism.ports[readout.of].items() if x}
            if row:
                kinds[readout.kind][name] = row
    solution: dict[str, dict[str, float]] = {}
    rows: dict[str, Mapping[str, float]] = {}
    for kind in ("position", "velocity"):
        for coordinate, found in _solve(kinds[kind], tuple(mechanism.coordinates)).items():
            if coordinate not in solution:
                solution[coordinate] = found
                rows.update({c: kinds[kind][c] for c in found})
    rates = frozenset(c for c in rows if c in kinds["velocity"])
    return Observers(rows, rates, solution)


def _solve(rows: Mapping[str, Mapping[str, float]], coordinates: tuple[str, ...]) -> dict[str, dict[str, float]]:
    if not rows:
        return {}
    matrix = np.array([[row.get(c, 0.0) for c in coordinates] for row in rows.values()])
    inverse = np.linalg.pinv(matrix)
    known = inverse @ matrix
    out = {}
    for i, coordinate in enumerate(coordinates):
        if np.abs(known[i] - np.eye(len(coordinates))[i]).max() < 1e-9:
            out[coordinate] = {c: float(x) for c, x in zip(rows, inverse[i], strict=True) if abs(x) > 1e-12}
    return out


@dataclass(frozen=True, eq=False)
class State:
    """Smoothed displacement and rate at given times, with standard errors. N times."""

    time: np.ndarray  # (N,) s, ascending
    d: np.ndarray  # (N,) m or rad
    v: np.ndarray  # (N,)
    d_error: np.ndarray  # (N,)
    v_error: np.ndarray  # (N,)

    @property
    def moved(self) -> np.ndarray:
        """d where it stands clear of its error nearby, else zero, shape (N,)."""
        return np.where(_clear(self.time, self.d, self.d_error), self.d, 0.0)

    @property
    def moving(self) -> np.ndarray:
        """v where it stands clear of its error nearby, else zero, shape (N,)."""
        return np.where(_clear(self.time, self.v, self.v_error), self.v, 0.0)

    @property
    def resting(self) -> np.ndarray:
        """Whether v does not stand clear of its error nearby, shape (N,) bool."""
        return ~_clear(self.time, self.v, self.v_error)

    @property
    def way(self) -> np.ndarray:
        """Expected sign of v, in (-1, 1), zero at rest, shape (N,)."""
        return np.asarray(erf(self.moving / (np.sqrt(2.0) * np.maximum(self.v_error, 1e-300))))


def _clear(time: np.ndarray, value: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Whether a value exceeds BEYOND errors within NEARBY; an oscillation is not chopped at its zeros."""
    strong = time[np.abs(value) > BEYOND * error]
    if not strong.size:
        return np.zeros(time.shape, dtype=bool)
    after = np.searchsorted(strong, time)
    before = np.clip(after - 1, 0, None)
    gap = np.minimum(np.abs(time - strong[before]), np.abs(time - strong[np.minimum(after, strong.size - 1)]))
    return np.asarray(gap <= NEARBY)


@dataclass(frozen=True, eq=False)
class Track:
    """One channel: what the model expects of it under the measured force, and the remainder, smoothed.

    Attributes:
        smooth: of the samples minus `known`, stretch by stretch.
        known_time, known: what is expected of the channel, shape (K,) each.
        known_rate: its derivative, shape (K,).
        known_bend: the second derivative of the displacement, shape (K,).
        rate: whether the channel reads a rate.
    """

    smooth: Pieces
    known_time: np.ndarray
    known: np.ndarray
    known_rate: np.ndarray
    known_bend: np.ndarray
    rate: bool

    def remainder(self, series: Series) -> np.ndarray:
        """The samples minus what is expected of them, shape (T,)."""
        return np.asarray(series.value - np.interp(series.time, self.known_time, self.known))

    def at(self, times: np.ndarray) -> State:
        """What it says of displacement and rate at ascending times, shape (N,)."""
        base = np.interp(times, self.known_time, self.known)
        slope = np.interp(times, self.known_time, self.known_rate)
        if not self.rate:
            return State(
                times,
                self.smooth.value(times) + base,
                self.smooth.value(times, 1) + slope,
                self.smooth.error(times),
                self.smooth.error(times, 1),
            )
        v = self.smooth.value(times) + base
        step = np.concatenate([[0.0], 0.5 * np.diff(times) * (v[1:] + v[:-1])])
        error = self.smooth.error(times)
        return State(times, np.cumsum(step), v, np.zeros_like(v), error)
