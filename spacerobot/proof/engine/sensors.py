"""Sensors: what the lab's instruments make of a run; their faults, and the nuisance that no catalogue holds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.signal import bessel, butter, lfilter, lfilter_zi, sosfilt, sosfilt_zi

from spacerobot.proof.engine.arm import CHAIN, POSE
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.engine.run import Log

GRID = 2e-5
"""Spacing [s] of the grid on which analogue filters act."""

ANTI_ALIAS = 2000.0
"""Corner [Hz] of the force amplifier's own filter, whose delay the lab has taken out of its time stamps."""

COLUMNS = {
    "target.x": "x_target_m",
    "wrist.x": "x_wrist_m",
    "hand.x": "x_hand_m",
    "target.y": "y_target_m",
    "target.yaw": "yaw_target_rad",
    "contact.force": "f_contact_N",
}
"""Channel -> column of its file."""


@dataclass(frozen=True)
class Channel:
    """One column of a stream: its noise (one standard deviation, stated or not) and the step of its digits."""

    name: str
    sigma: float
    quantum: float
    stated: bool = True


@dataclass(frozen=True)
class Stream:
    """One instrument.

    Attributes:
        name: in the study, "mocap" or "force".
        sensor: as verdicts call it.
        rate: samples a second.
        channels: what it records.
        coloured: share of the noise variance that is coloured.
        memory: correlation of the coloured part from sample to sample.
        late: residual delay of the time stamps [s], too small to matter.
        dropouts: gaps a second, each of up to five samples.
    """

    name: str
    sensor: str
    rate: float
    channels: tuple[Channel, ...]
    coloured: float = 0.0
    memory: float = 0.8
    late: float = 0.0
    dropouts: float = 0.0


@dataclass(frozen=True, eq=False)
class Reading:
    """One stream of one trial: times shape (T,), values by channel shape (T,), NaN where a reading is lost."""

    time: np.ndarray
    value: Mapping[str, np.ndarray]
    lost: np.ndarray  # (T,) bool: rows that are missing altogether


def truth_of(log: Log) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Channel -> (times, values) of what happened."""
    found = {
        "target.x": log.position["target"],
        "wrist.x": log.slider[0],
        "hand.x": log.hand,
        "contact.force": log.force,
    }
    for name, value in log.position.items():
        kind, _, own = name.partition(".")
        if kind == "joint":
            found[f"{name}.position"] = value + POSE[CHAIN.index(own)]
        elif kind == "base":
            found[f"base.position.{own}" if own in "xyz" else name] = value
        else:
            found.setdefault(name, value)
    return {name: (log.time, value) for name, value in found.items()}


def read(log: Log, stream: Stream, faults: tuple[Missing, ...]) -> Reading:
    """The stream without noise, as its sensor with its faults shows the run.

    Args:
        log: what happened.
        stream: the instrument.
        faults: sensor effects at this instrument.
    """
    truth = truth_of(log)
    times = np.arange(0.0, log.time[-1] - 1e-9, 1.0 / stream.rate)
    value = {c.name: _channel(c.name, *truth[c.name], log, stream, faults, times) for c in stream.channels}
    return Reading(times, value, np.zeros(times.size, dtype=bool))


def spoil(reading: Reading, stream: Stream, rng: np.random.Generator) -> Reading:
    """The reading with noise, drop-outs and rounding."""
    size = reading.time.size
    out = {}
    for channel in stream.channels:
        white = rng.standard_normal(size)
        b, a = [math.sqrt(1.0 - stream.memory**2)], [1.0, -stream.memory]
        colour = lfilter(b, a, rng.standard_normal(size + 200))[200:]
        noise = math.sqrt(1.0 - stream.coloured) * white + math.sqrt(stream.coloured) * colour
        noisy = reading.value[channel.name] + channel.sigma * noise
        out[channel.name] = np.round(noisy / channel.quantum) * channel.quantum
    lost = np.zeros(size, dtype=bool)
    for _ in range(rng.poisson(stream.dropouts * size / stream.rate)):
        first, count = int(rng.integers(0, size)), int(rng.integers(1, 6))
        if rng.random() < 0.5:
            lost[first : first + count] = True
        else:
            for values in out.values():
                values[first : first + count] = np.nan
    return Reading(reading.time, out, lost)


def _channel(
    name: str,
    time: np.ndarray,
    value: np.ndarray,
    log: Log,
    stream: Stream,
    faults: tuple[Missing, ...],
    at: np.ndarray,
) -> np.ndarray:
    p = {f.effect: f.values for f in faults}
    form = next((f.form for f in faults if f.effect == "low_pass"), (1, ""))
    late = stream.late
    if "sensor_inertia" in p and name == "contact.force":
        value = value - p["sensor_inertia"]["mass_kg"] * _acceleration(log)
    cutoff = p["low_pass"]["cutoff_Hz"] if "low_pass" in p else None
    if name == "contact.force" or cutoff is not None:
        grid = np.arange(time[0], time[-1] + GRID, GRID)
        value, time = np.interp(grid, time, value), grid
        if cutoff is not None:
            value = _smoothed(value, cutoff, *form)
        if name == "contact.force":
            numerator, denominator = butter(2, ANTI_ALIAS, fs=1.0 / GRID)
            start = value[0] * lfilter_zi(numerator, denominator)
            value, _ = lfilter(numerator, denominator, value, zi=start)
            late -= math.sqrt(2.0) / (2.0 * math.pi * ANTI_ALIAS)
    late += p.get("time_offset", {}).get("delay_s", 0.0)
    found = np.interp(at - late, time, value)
    found = found * p.get("scale", {}).get("factor", 1.0)
    return found + p.get("bias", {}).get("value", 0.0)


def _smoothed(value: np.ndarray, cutoff: float, order: int, kind: str) -> np.ndarray:
    """An amplifier's filter on the grid: of the first order by its decay, of a higher one by scipy's digital design."""
    if order == 1:
        decay = math.exp(-2.0 * math.pi * cutoff * GRID)
        b, a = [0.5 * (1.0 - decay), 0.5 * (1.0 - decay)], [1.0, -decay]
        out, _ = lfilter(b, a, value, zi=value[0] * lfilter_zi(b, a))
        return np.asarray(out)
    made = {"butterworth": butter(order, cutoff, fs=1.0 / GRID, output="sos")}
    if kind == "bessel":
        made[kind] = bessel(order, cutoff, fs=1.0 / GRID, norm="mag", output="sos")
    out, _ = sosfilt(made[kind], value, zi=value[0] * sosfilt_zi(made[kind]))
    return np.asarray(out)


def _acceleration(log: Log) -> np.ndarray:
    """World acceleration of the slider from its velocity, one-sided where steps meet at one time."""
    v = log.slider[1]
    rate = np.zeros_like(v)
    dt = np.diff(log.time)
    slope = np.divide(np.diff(v), dt, out=np.zeros_like(dt), where=dt > 1e-12)
    for i in np.flatnonzero(dt <= 1e-12):
        slope[i] = slope[i - 1]  # a touch: the force jumps, the velocity does not
    rate[1:] = slope
    rate[0] = slope[0]
    return rate
