"""What is wrong with a sensor: its faults as patterns in the balances, and how late the force is against positions."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from spacerobot.diagnosis.locate.laws import TARGET, push
from spacerobot.diagnosis.locate.located import Clock
from spacerobot.diagnosis.locate.motion import EDGE
from spacerobot.diagnosis.locate.prepared import Prepared
from spacerobot.diagnosis.locate.readings import Series
from spacerobot.diagnosis.locate.samples import Integral, trapezoid
from spacerobot.diagnosis.locate.weak_trial import WeakTrial

LARGEST = 0.02
"""Delays sought, to either side [s]."""

ROUNDS = 5
"""Halvings of the spread around the best delay so far; each tries five."""


def clocks(prepared: Mapping[str, Prepared]) -> tuple[Clock, ...]:
    """The delay of the contact force against the target's track; none where either is not measured."""
    used = [_Curve(p, p.weak.force) for p in prepared.values() if p.weak.force is not None and TARGET in p.found]
    used = [u for u in used if u.usable]
    if not used:
        return ()
    tried: dict[float, float] = {}

    def misfit(delay: float) -> float:
        if delay not in tried:
            tried[delay] = sum(u.chi2(delay) for u in used)
        return tried[delay]

    best, spread = 0.0, 0.5 * LARGEST
    for _ in range(ROUNDS):
        candidates = [best + k * spread for k in (-2, -1, 0, 1, 2) if abs(best + k * spread) <= LARGEST]
        best = min(candidates, key=misfit)
        spread *= 0.5
    step = 2.0 * spread
    low, middle, high = misfit(best - step), misfit(best), misfit(best + step)
    bend = low - 2.0 * middle + high
    if bend <= 0.0:
        return ()
    shift = 0.5 * step * (low - high) / bend
    sensor = next((n for n, c in used[0].one.mechanism.sensors.items() if used[0].force.channel in c), "contact.force")
    lowest = middle - (low - high) ** 2 / (8.0 * bend)
    return (Clock(sensor, best + shift, step * float(np.sqrt(2.0 / bend)), misfit(0.0) - lowest),)


class _Curve:
    """chi-squared of one trial's target balance against the delay of the force."""

    def __init__(self, one: Prepared, force: Series) -> None:
        self.one, self.force = one, force
        weak = one.weak
        balance = one.found[TARGET]
        self.usable = bool(weak.touches.stretches)
        if not self.usable:
            return
        self.whiten = one.tested(TARGET).whiten
        weight = trapezoid(force.time)
        # only the contact is moved: outside it there is nothing but noise
        pressed = weak.touches.inside(force.time, EDGE)
        by = push(one.mechanism, weak.yaw, force.time)[TARGET]
        self.time = force.time[pressed]
        self.drive = (by * force.value * weight)[pressed]
        self.rest = balance.residual.value - self._integral(0.0)

    def _integral(self, delay: float) -> np.ndarray:
        return np.asarray(self.one.weak.windows.values(self.time - delay, 0) @ self.drive)

    def chi2(self, delay: float) -> float:
        """With the force read `delay` seconds late."""
        white = self.whiten(self.rest + self._integral(delay))
        return float(white @ white)


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
