"""Events inside a step: guards bracketed so that none is missed, and located. Compiled."""

from __future__ import annotations

from typing import Any

from spacerobot.simulation.multibody.machine import guards_at
from spacerobot.simulation.multibody.stepper import interpolate
from spacerobot.simulation.reduced.forces import PRESSED
from spacerobot.support.jit import lean

SAMPLES = 8
"""Parts of a step at whose ends the guards are looked at; between them, at every extremum of the gap."""


@lean
def _at(m: Any, t: float, y: Any, h: float, f: Any, theta: float, temp: Any, slope: Any, g: Any) -> float:
    """All guards into `g` at a fraction of the step; returns the rate of the penetration."""
    interpolate(y, f, theta, temp)
    return float(guards_at(m, t + theta * h, temp, g, slope))


@lean
def first_event(
    m: Any, t: float, y: Any, h: float, f: Any, temp: Any, slope: Any, g: Any, samples: Any, rates: Any
) -> Any:
    """The first guard that falls below zero in the step: (index, fraction), or (-1, 2.0).

    Args:
        m: the machine, in its modes.
        t, y, h, f: time, state, length and interpolant of the step.
        temp, slope, g: overwritten, shapes of y, y and the modes.
        samples, rates: overwritten, shapes (SAMPLES + 1, G) and (SAMPLES + 1,).
    """
    for j in range(SAMPLES + 1):
        rates[j] = _at(m, t, y, h, f, j / SAMPLES, temp, slope, samples[j])
    best, where = -1, 2.0
    for i in range(samples.shape[1]):
        low, high = _bracket(m, t, y, h, f, temp, slope, g, samples, rates, i)
        if 0.0 <= low < where:
            theta = _root(m, t, y, h, f, temp, slope, g, i, low, high)
            if theta < where:
                best, where = i, theta
    return best, where


@lean
def _bracket(
    m: Any, t: float, y: Any, h: float, f: Any, temp: Any, slope: Any, g: Any, samples: Any, rates: Any, i: int
) -> Any:
    """Fractions between which guard i falls through zero for the first time; (-1, -1) if it does not."""
    apart = i == 0 and m.modes[0] != PRESSED
    for j in range(1, SAMPLES + 1):
        low, here = (j - 1) / SAMPLES, samples[j, i]
        if here < 0.0:
            return _inside(m, t, y, h, f, temp, slope, g, i, low, j / SAMPLES)
        dip = -1.0
        if apart:
            if rates[j - 1] > 0.0 and rates[j] < 0.0:
                dip = _deepest(m, t, y, h, f, temp, slope, g, low, j / SAMPLES)
        elif j < SAMPLES and here <= samples[j - 1, i] and here <= samples[j + 1, i]:
            curve = samples[j - 1, i] - 2.0 * here + samples[j + 1, i]
            if curve > 0.0:
                dip = (j + 0.5 * (samples[j - 1, i] - samples[j + 1, i]) / curve) / SAMPLES
        if dip >= 0.0:
            _at(m, t, y, h, f, dip, temp, slope, g)
            if g[i] < 0.0:
                return _inside(m, t, y, h, f, temp, slope, g, i, low if dip > low else low - 1.0 / SAMPLES, dip)
    return -1.0, -1.0


@lean
def _deepest(
    m: Any, t: float, y: Any, h: float, f: Any, temp: Any, slope: Any, g: Any, low: float, high: float
) -> float:
    """Where the rate of the penetration turns negative."""
    for _ in range(40):
        middle = 0.5 * (low + high)
        if _at(m, t, y, h, f, middle, temp, slope, g) > 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@lean
def _inside(
    m: Any, t: float, y: Any, h: float, f: Any, temp: Any, slope: Any, g: Any, i: int, low: float, high: float
) -> Any:
    """The bracket with its start moved off a zero at which the mode itself began."""
    if low > 0.0:
        return low, high
    low = max(low, 0.0)
    _at(m, t, y, h, f, low, temp, slope, g)
    if g[i] > 0.0:
        return low, high
    theta = high
    for _ in range(40):
        theta *= 0.5
        _at(m, t, y, h, f, theta, temp, slope, g)
        if g[i] > 0.0:
            return theta, high
    return 0.0, 0.0


@lean
def _root(
    m: Any, t: float, y: Any, h: float, f: Any, temp: Any, slope: Any, g: Any, i: int, low: float, high: float
) -> float:
    """The zero of guard i in a bracket, by regula falsi (Illinois); the side on which it is negative."""
    if high <= low:
        return high
    _at(m, t, y, h, f, low, temp, slope, g)
    above = g[i]
    _at(m, t, y, h, f, high, temp, slope, g)
    below = g[i]
    side = 0
    for _ in range(80):
        if high - low < 1e-14:
            break
        middle = (low * below - high * above) / (below - above) if below != above else low
        if not low < middle < high:
            middle = 0.5 * (low + high)
        _at(m, t, y, h, f, middle, temp, slope, g)
        value = g[i]
        if value < 0.0:
            high, below = middle, value
            above *= 0.5 if side == -1 else 1.0
            side = -1
        elif value > 0.0:
            low, above = middle, value
            below *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            return middle
    return high
