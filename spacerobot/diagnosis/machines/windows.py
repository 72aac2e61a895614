"""Recorded motion cut into windows that restart, how each begins, and the drives that act in it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np

from spacerobot.diagnosis.machines.measured import through_sensor
from spacerobot.diagnosis.machines.touch import Moment
from spacerobot.diagnosis.terms.data import Block, TrialData, piece_id
from spacerobot.diagnosis.terms.decision import MOVED
from spacerobot.effects.primitives import ChannelMap

PIECES = 8
"""Into how many parts a trial, or its events, are cut, so that there is something to hold out."""

FOLDS = 4
"""Into how many parts a study of one condition is divided."""

ENOUGH = 256
"""Readings a window keeps; more frequent ones are thinned, since a fit gains nothing from them."""


@dataclass(frozen=True, eq=False)
class Turned:
    """Forces that were commanded along a body's own axes, and how the body was turned.

    Attributes:
        ahead, aside: their channels, as they are in the world.
        time: of the yaw, shape (N,) [s].
        yaw: as recorded, shape (N,) [rad].
    """

    ahead: str
    aside: str
    time: np.ndarray
    yaw: np.ndarray

    def by(self, value: Mapping[str, np.ndarray], time: np.ndarray, way: float) -> dict[str, np.ndarray]:
        """The forces at these times, shape (T,), turned with the body (way 1), or back into its axes (-1)."""
        angle = way * np.interp(time, self.time, self.yaw)
        x, y = value[self.ahead], value[self.aside]
        cos, sin = np.cos(angle), np.sin(angle)
        return {**value, self.ahead: cos * x - sin * y, self.aside: sin * x + cos * y}


@dataclass(frozen=True, eq=False)
class Drive:
    """Recorded inputs of one trial on times of their own. U inputs, T times."""

    time: np.ndarray  # (T,) s
    value: Mapping[str, np.ndarray]  # channel -> (T,)
    jumps: np.ndarray = field(default_factory=lambda: np.zeros(0))  # times at which an integrator must stop
    beside: Mapping[str, np.ndarray] = field(default_factory=dict)  # "CHANNEL|COLUMN" -> (T,), see `doubted.py`
    spacing: float = 0.0  # of which this is a part [s]; its own where zero
    turned: Turned | None = None  # where forces in `value` are along a body's axes by nature

    @cached_property
    def step(self) -> float:
        """Typical spacing of the times [s]; where a command holds, of its changes."""
        if self.spacing:
            return self.spacing
        gaps = np.diff(self.time)
        return float(np.median(gaps[gaps > 2.0 * EDGE]))

    @cached_property
    def bends(self) -> bool:
        """Whether it changes between its jumps too, where no integrator stops."""
        slow = np.diff(self.time) > 2.0 * EDGE
        return any(bool(np.any(np.diff(v)[slow])) for v in self.value.values())

    def turning(self, turned: Turned) -> Drive:
        """The same where its forces are along a body's axes: in the world, they turn with the body while they hold."""
        inside = (turned.time > self.time[0]) & (turned.time < self.time[-1])
        time = np.unique(np.concatenate([self.time, turned.time[inside]]))
        held = {c: np.interp(time, self.time, v) for c, v in self.value.items()}
        beside = {c: np.interp(time, self.time, v) for c, v in self.beside.items()}
        return Drive(time, turned.by(held, time, 1.0), self.jumps, beside, spacing=self.step, turned=turned)

    def times(self, factor: float) -> Drive:
        """The same inputs, so many times as strong."""
        value, beside = ({c: factor * v for c, v in of.items()} for of in (self.value, self.beside))
        return replace(self, value=value, beside=beside)

    def told(self, beyond: Callable[[str], float]) -> Drive:
        """The inputs as they truly were, with each doubted column's factor so much larger than believed."""
        if not self.beside:
            return self
        value = dict(self.value)
        for key, column in self.beside.items():
            channel = key.partition("|")[0]
            value[channel] = value[channel] + beyond(key) * column
        return replace(self, value=value, beside={})

    def through(self, maps: Sequence[ChannelMap], start: float, end: float) -> Drive:
        """What of the recorded command comes out, from `start` to `end`: weaker, later, or sluggish.

        What was commanded along a body's axes acts along them when it comes out, however the body has turned since.
        """
        own = {c: tuple(m for m in maps if m.channel == c) for c in self.value}
        if not any(own.values()):
            return self
        if self.turned is not None and (own[self.turned.ahead] or own[self.turned.aside]):
            plain = replace(self, value=self.turned.by(self.value, self.time, -1.0), turned=None)
            out = plain.through(maps, start, end)
            return replace(out, value=self.turned.by(out.value, out.time, 1.0))
        delays = {sum(m.value for m in some if m.kind == "delay") for some in own.values()}
        if len(delays) == 1 and all(m.kind in ("gain", "offset", "delay") for some in own.values() for m in some):
            (delay,) = delays  # all come out so much later, as they are
            first, last = np.searchsorted(self.time, [start - delay, end - delay])
            part = slice(max(int(first) - MARGIN, 0), int(last) + MARGIN)
            rest = {c: tuple(m for m in some if m.kind != "delay") for c, some in own.items()}
            shown = {c: through_sensor(rest[c], v[part], 1.0) for c, v in self.value.items()}
            return Drive(self.time[part] + delay, shown, self.jumps + delay, spacing=self.step)
        late = sum(abs(m.value) for some in own.values() for m in some if m.kind == "delay")
        # points of its own between the corners: a grid that moved with `start` would leap from corner to corner
        fine = self.step / FINER
        first, last = ((t - self.time[0]) / fine for t in (start - late - SETTLE * self.step, end + late))
        grid = self.time[0] + fine * (np.arange(np.floor(first), np.ceil(last) + 1.0) + 0.5)
        value = {
            c: through_sensor(own[c], np.interp(grid, self.time, v), self.step / FINER) for c, v in self.value.items()
        }
        return Drive(grid, value)


MARGIN = 4
"""Times to either side of a window that its part of a command keeps."""

FINER = 4
"""Points between two corners of a command that comes out late or sluggish."""

SETTLE = 40
"""Corners before a window in which a sluggish command forgets what came before."""

EDGE = 1e-6
"""Time [s] that a command takes to change."""


WITHIN = 1.0 / MOVED
"""Standard deviation of a moment that lies within one sample to either side, in samples: whether an input was logged
before its motion or after, or held until the next one, no log says. What comes later than that is late."""


def moment(name: str, known: Collection[str], steps: Iterable[float]) -> dict[str, float]:
    """What is believed of when an input acted, where nothing is known of it: its name -> standard deviation [s].

    Args:
        name: of the value that says by how much the input's log is late.
        known: names of values of which something is known.
        steps: from sample to sample, by log [s].
    """
    return {} if name in known else {name: WITHIN * float(np.median(list(steps)))}


CHANGED = 0.05
"""Share of an input's range by which it changes where it does: less is a sensor's noise, or slow control."""


def commanded(
    channels: Mapping[str, tuple[np.ndarray, np.ndarray]],
    beside: Mapping[str, tuple[np.ndarray, np.ndarray]] = MappingProxyType({}),
) -> Drive:
    """Commands that each hold until their next one, by channel: times and values, shape (T,) each; and what is beside.

    Where one leaps an integrator must stop; small changes are joined by lines from the middle of one command to that of
    the next, which push as much.
    """
    times = np.unique(np.concatenate([t for t, _ in channels.values()]))
    every = {**channels, **beside}
    held = {c: v[np.clip(np.searchsorted(t, times + EDGE, "right") - 1, 0, t.size - 1)] for c, (t, v) in every.items()}
    ends = np.append(times[1:], times[-1] + float(np.median(np.diff(times))))
    leaps = np.zeros(times.size - 1, dtype=bool)
    for held_value in held.values():
        leaps |= np.abs(np.diff(held_value)) > CHANGED * np.ptp(held_value)
    begins, stops = np.append(True, leaps), np.append(leaps, True)
    corners = np.stack([times + EDGE, 0.5 * (times + ends), ends], axis=1)
    kept = np.stack([begins, np.ones(times.size, dtype=bool), stops], axis=1)
    jumps = np.concatenate([times[begins] + EDGE, ends[stops]])
    value = {c: np.repeat(v, 3)[kept.ravel()] for c, v in held.items()}
    inside, outside = ({c: v for c, v in value.items() if c in of} for of in (channels, beside))
    return Drive(corners.ravel()[kept.ravel()], inside, np.sort(jumps), outside)


def band_limited(time: np.ndarray, value: np.ndarray, factor: int) -> tuple[np.ndarray, np.ndarray]:
    """A sampled signal between its samples: times and values at `factor` times the rate.

    By Fourier interpolation of the signal and its mirror image, so that the ends do not ring.
    """
    from scipy.signal import resample

    both = np.concatenate([value, value[::-1]])
    fine = resample(both, factor * both.size)[: factor * value.size]
    step = float(np.median(np.diff(time)))
    return time[0] + step / factor * np.arange(fine.size), np.asarray(fine)


BEND = 0.08
"""Second difference of neighbours, as a share of a signal's spread, that lines may cut short; what reaches the motion
is a tenth of it (silverbox: 0.2 % of the output)."""


def refinement(value: np.ndarray) -> int:
    """How many points a sample needs for lines between them to follow a signal: 1 where neighbours are alike."""
    spread = float(np.std(value))
    if spread == 0.0:
        return 1
    bend = float(np.sqrt(np.mean(np.diff(value, 2) ** 2))) / spread  # of the order of (omega dt)^2
    return int(np.clip(np.ceil(np.sqrt(bend / BEND)), 1, 8))


def cut(trial: TrialData, length: float, moments: Sequence[Moment] = ()) -> list[TrialData]:
    """The trial in windows of `length` seconds (an infinite one: whole), a rest of less than half of one left out.

    Each stretch between `moments` is cut by itself; readings within a moment's interval belong to none.
    """
    inside = sorted((m for m in moments if trial.start < m.low and m.high < trial.end), key=lambda m: m.time)
    begins, ends_at = [trial.start, *(m.high for m in inside)], [*(m.low for m in inside), trial.end]
    spans: list[tuple[float, float]] = []
    for first, last in zip(begins, ends_at, strict=True):
        count = 1 if last - first < 1.5 * length else int((last - first) / length + 0.5)
        close = last + 1e-6 * (last == trial.end)
        ends = [close] if count == 1 else [min(first + (n + 1) * length, close) for n in range(count)]
        spans += zip([first, *ends[:-1]], ends, strict=True)
    out = []
    for n, (begin, end) in enumerate(spans):
        blocks = tuple(b for b in (_within(b, begin, end) for b in trial.blocks) if b.time.size)
        if blocks and any((b.weight > 0.0).sum() > 4 for b in blocks):
            name = piece_id(trial.id, n) if len(spans) > 1 else trial.id
            out.append(replace(trial, id=name, blocks=blocks, start=float(begin), end=float(min(end, trial.end))))
    return out


def _within(block: Block, begin: float, end: float) -> Block:
    index = np.flatnonzero((block.time >= begin - 1e-9) & (block.time < end - 1e-9))
    index = index[:: max(1, index.size // ENOUGH)]
    return replace(block, time=block.time[index], value=block.value[:, index], weight=block.weight[:, index])


def overlap(one: TrialData, other: TrialData) -> bool:
    """Whether two windows of one recorded trial have some of it in common."""
    return one.recorded == other.recorded and one.start < other.end - 1e-9 and other.start < one.end - 1e-9


def spread_over(trials: list[TrialData], samples: int, kept: Collection[str] = ()) -> list[TrialData]:
    """So many of the windows, evenly over all of them, that they hold about this many readings; and those kept."""
    total = sum(t.samples for t in trials)
    keep = max(2, int(len(trials) * min(1.0, samples / max(total, 1))))
    index = np.unique(np.linspace(0, len(trials) - 1, keep).round().astype(int))
    return [t for i, t in enumerate(trials) if i in index or t.id in kept]


def beside(trials: Sequence[TrialData], moments: Mapping[str, Sequence[Moment]]) -> set[str]:
    """Of windows, those that end and begin next to one of a trial's moments."""
    out: set[str] = set()
    for recorded, some in moments.items():
        own = sorted((t for t in trials if t.recorded == recorded), key=lambda t: t.start)
        for moment in some:
            out |= {t.id for t in [t for t in own if t.start < moment.time][-1:]}
            out |= {t.id for t in [t for t in own if t.start >= moment.time][:1]}
    return out


@dataclass(frozen=True)
class Local:
    """Value and slope of a channel at a moment, with their standard deviations."""

    value: float
    slope: float
    value_sigma: float
    slope_sigma: float


def local(time: np.ndarray, value: np.ndarray, at: float, reach: float, least: int = 8) -> Local:
    """A cubic fitted to the readings within `reach` seconds of a moment, and to `least` of them at least."""
    order = np.argsort(np.abs(time - at))
    count = max(least, int((np.abs(time - at) <= reach).sum()))
    near = np.sort(order[:count])
    t, y = time[near] - at, value[near]
    scale = max(float(np.abs(t).max()), 1e-12)
    powers = (t / scale)[:, None] ** np.arange(min(4, max(2, near.size - 2)))
    found, *_ = np.linalg.lstsq(powers, y, rcond=None)
    rest = y - powers @ found
    variance = float(rest @ rest) / max(near.size - powers.shape[1], 1)
    covariance = variance * np.linalg.pinv(powers.T @ powers)
    sigma = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return Local(float(found[0]), float(found[1] / scale), float(sigma[0]), float(sigma[1] / scale))
