"""What sensors show of a run: readouts of the mechanism, passed through its channel maps."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from spacerobot.effects.filters import BOTH_WAYS, first_orders, summed
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap, Readout
from spacerobot.support.errors import NotFoundError


class Run(Protocol):
    """A finished run of either backend, as sensors need it."""

    @property
    def start(self) -> float:
        """First time [s]."""

    def states(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates' positions and velocities, shape (T, n) each."""

    def positions(self, times: np.ndarray) -> np.ndarray:
        """Coordinates' positions alone, shape (T, n)."""

    def accelerations(self, times: np.ndarray) -> np.ndarray:
        """Coordinates' accelerations alone, shape (T, n)."""

    def contact_at(self, times: np.ndarray) -> np.ndarray:
        """Contact force, shape (T,) [N]."""

    def port(self, name: str, states: np.ndarray) -> np.ndarray:
        """A port's value from the coordinates', shape (T,)."""

    def ports(self, names: Sequence[str], states: np.ndarray) -> np.ndarray:
        """Several ports' values from the coordinates', shape (P, T)."""

    def switches(self) -> np.ndarray:
        """Times at which a mode changes, ascending, shape (E,) [s]: there forces and accelerations jump."""


def read_channels(run: Run, mechanism: Mechanism, channels: Iterable[str], times: np.ndarray) -> dict[str, np.ndarray]:
    """The channels as the sensors would record them at `times`.

    Args:
        run: a finished run of the mechanism.
        mechanism: its readouts and channel maps.
        channels: names, e.g. "target.x".
        times: ascending, shape (T,) [s].

    Returns:
        channel -> values, shape (T,), SI.

    Raises:
        NotFoundError: a channel that the mechanism does not show.
    """
    out: dict[str, np.ndarray] = dict.fromkeys(channels, times)  # in this order
    mapped = {m.channel for m in mechanism.maps}
    taken: dict[object, _Taken] = {0.0: _Taken(run, times)}
    bare: dict[str, list[str]] = {}  # by kind, channels that show a port and nothing else
    for channel in out:
        readout = mechanism.readouts.get(channel)
        if readout is None:
            raise NotFoundError("channel", channel, mechanism.readouts)
        if readout.kind != "force" and channel not in mapped:
            bare.setdefault(readout.kind, []).append(channel)
            continue
        maps = sorted((m for m in mechanism.maps if m.channel == channel), key=lambda m: m.rank)
        out[channel] = _read(run, readout, maps, times, taken)
    for kind, some in bare.items():
        readouts = [mechanism.readouts[channel] for channel in some]
        values = run.ports([r.of for r in readouts], taken[0.0].of(kind))
        for channel, readout, value in zip(some, readouts, values, strict=True):
            out[channel] = value if readout.sign == 1.0 else readout.sign * value
    return out


@dataclass(frozen=True)
class _Taken:
    """What a run holds at some times, found when first asked for: most channels need no force evaluated."""

    run: Run
    times: np.ndarray

    @functools.cached_property
    def position(self) -> np.ndarray:
        return self.run.positions(self.times)

    @functools.cached_property
    def velocity(self) -> np.ndarray:
        return self.run.states(self.times)[1]

    @functools.cached_property
    def acceleration(self) -> np.ndarray:
        return self.run.accelerations(self.times)

    def of(self, kind: str) -> np.ndarray:
        """Coordinates' positions, velocities or accelerations, shape (T, n)."""
        return np.asarray(getattr(self, kind))


MEMORY = 16.0
"""Time constants after which a filter has forgotten: to a part in ten million."""


def _read(
    run: Run, readout: Readout, maps: list[ChannelMap], times: np.ndarray, taken: dict[object, _Taken]
) -> np.ndarray:
    late = sum(m.value for m in maps if m.kind == "delay")
    filters = [m for m in maps if m.kind == "low_pass" and math.isfinite(m.value)]
    riding = [m for m in maps if m.kind in ("inertia", "lever") and m.value != 0.0]
    if filters:
        value = _filtered(run, readout, riding, filters, times - late, taken)
    else:
        if late not in taken:
            taken[late] = _Taken(run, times - late)
        value = _raw(run, readout, riding, taken[late])
    for m in maps:
        if m.kind == "gain":
            value = value * m.value
        elif m.kind == "offset":
            value = value + m.value
    return value


def _raw(run: Run, readout: Readout, riding: list[ChannelMap], taken: _Taken) -> np.ndarray:
    if readout.kind == "force":
        value = readout.sign * run.contact_at(taken.times)
    else:
        value = readout.sign * run.port(readout.of, taken.of(readout.kind))
    for m in riding:
        assert m.of is not None  # such a map names the port it rides on
        if m.kind == "inertia":
            value = value - m.value * run.port(m.of, taken.acceleration)
        else:
            kinds = ("position", "velocity", "acceleration")
            turned = [run.port(m.of, taken.of(kind)) for kind in kinds[: kinds.index(readout.kind) + 1]]
            value = value + m.lever(*turned)
    return value


def _filtered(
    run: Run,
    readout: Readout,
    riding: list[ChannelMap],
    filters: list[ChannelMap],
    times: np.ndarray,
    taken: dict[object, _Taken],
) -> np.ndarray:
    """Low-pass filters, exact for an input that is linear between the points of a grid but for jumps at events.

    So the grid need not resolve the filter, only the channel: a contact lasts milliseconds, a body moves smoothly. A
    jump is taken when it happens: moved to the grid it would move the reading by its height, and the cost of a fit
    would jump wherever a touch crosses a point of the grid.
    """
    spacing = _usual(np.diff(times)) if times.size > 1 else 1e-3
    cutoffs = [m.value for m in filters]
    fastest = 1.0 / (2.0 * math.pi * max(cutoffs))
    smooth = readout.kind == "position" and not riding
    step = max(min(0.5 * spacing, 0.25 * fastest), 1e-3) if smooth else min(0.5 * spacing, 0.25 * fastest, 2e-4)
    step = max(step, 1e-4)
    # start early enough that the filter has forgotten its start
    slowest = min(m.value * rate.real for m in filters for rate, _ in first_orders(*m.form))
    forgotten = MEMORY / (2.0 * math.pi * slowest)
    begin = max(times[0] - forgotten, run.start - step)
    grid = np.arange(begin, times[-1] + step, step)
    here = taken.setdefault((begin, step, grid.size), _Taken(run, grid))  # channels of one sensor share it
    value = _raw(run, readout, riding, here)
    if readout.kind == "force" and not riding:  # nothing but where bodies touch, and until that is forgotten
        pressed, beside = np.flatnonzero(value), math.ceil(forgotten / step) + 1
        if not pressed.size:
            return np.zeros_like(times)
        part = slice(max(pressed[0] - beside, 0), pressed[-1] + beside + 1)
        grid, value = grid[part], value[part]
    at, jump = _jumps(run, readout, riding, grid)
    for m in filters:
        value = _through(m, value, grid, at, jump)
        at = at[:0]  # what comes out has no jumps
        if m.form[1] == BOTH_WAYS:
            value = _through(m, value[::-1], grid, at, jump)[::-1]
    return np.interp(times, grid, value)


def _usual(spacings: np.ndarray) -> float:
    """The upper median [s]; numpy's own takes ten times as long over a few hundred."""
    middle = spacings.size // 2
    return float(np.partition(spacings, middle)[middle])


def _through(m: ChannelMap, value: np.ndarray, grid: np.ndarray, at: np.ndarray, jump: np.ndarray) -> np.ndarray:
    """One filter's output on an even grid, shape (T,), of an input that jumps by `jump` at times `at`, shape (E,)."""
    from scipy.signal import lfilter

    step, after = float(grid[1] - grid[0]), np.searchsorted(grid, at)

    def respond(rate: complex | float) -> np.ndarray:
        a: Any = 2.0 * math.pi * m.value * step * rate
        decay, come = np.exp(-a), -np.expm1(-a)
        late = 1.0 - come / a  # weight of the newer end of a linear piece
        early = come - late
        den = [1.0, -decay]
        own, _ = lfilter([late, early], den, value, zi=[(early + decay) * value[0]])
        if at.size:  # by the next point a step has come through this far, the ramp that stands for it so far
            beyond = np.zeros_like(own)
            np.add.at(beyond, after, jump * (-np.expm1(-a * (grid[after] - at) / step) - late))
            own = own + lfilter([1.0], den, beyond)
        return np.asarray(own)

    return summed(m.form, respond)


def _jumps(run: Run, readout: Readout, riding: list[ChannelMap], grid: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where a readout jumps within a grid, and by how much, shape (E,) each."""
    if readout.kind == "position" and not riding:
        return np.empty(0), np.empty(0)
    at = np.unique(run.switches())
    at = at[(at > grid[0]) & (at < grid[-1])]
    if not at.size:
        return at, at
    sides = np.stack([np.nextafter(at, -np.inf), at], axis=1)
    before, after = _raw(run, readout, riding, _Taken(run, sides.ravel())).reshape(-1, 2).T
    return at, after - before
