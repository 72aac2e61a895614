"""What a sensor's own faults would do to all balances that read it: a late clock, a wrong gain, an offset."""

from __future__ import annotations

import numpy as np

from spacerobot.diagnosis.locate.integral import Integral
from spacerobot.diagnosis.locate.weak_trial import WeakTrial

STENCIL = 2e-3
"""Half width [s] of the difference that stands for a force's rate."""


def faults(weak: WeakTrial, channels: tuple[str, ...], residual: Integral) -> dict[str, np.ndarray]:
    """Change of a balance per unit of each fault of a sensor, by what it depends on.

    A reading late by tau shows q - tau q', so its error is -tau times the rate.

    Args:
        weak: the trial.
        channels: of the sensor.
        residual: the balance's, R rows.

    Returns:
        "time" (per second), "gain" (per 1), "constant" (per unit), shape (R,) each.
    """
    out = {name: np.zeros(residual.value.size) for name in ("time", "gain", "constant")}
    for channel in channels:
        if channel not in residual.weights or channel not in weak.series:
            continue
        weights = residual.weights[channel]
        value, rate = _signal(weak, channel)
        out["time"] += -(weights @ rate)
        out["gain"] += weights @ value
        out["constant"] += weights @ np.ones(value.size)
    return out


def _signal(weak: WeakTrial, channel: str) -> tuple[np.ndarray, np.ndarray]:
    """A channel's own value and rate without its noise, shape (T,) each."""
    series = weak.series[channel]
    time = series.time
    if channel in weak.tracks:
        state = weak.tracks[channel].at(time)
        if weak.tracks[channel].rate:
            return state.v, np.gradient(state.v, time)
        return state.d, state.v
    half = max(STENCIL, series.step)
    if weak.force is not None and channel == weak.force.channel:
        pressed = np.where(weak.touches.inside(time, 2.0 * half), series.value, 0.0)
        late, early = np.interp(time - half, time, pressed), np.interp(time + half, time, pressed)
        sign = 1.0 if np.allclose(weak.force.value, series.value) else -1.0
        return sign * weak.soft_force, (early - late) / (2.0 * half)
    return series.value, np.gradient(series.value, time)
