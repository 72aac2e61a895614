"""What moves by itself on a measured coordinate, a link behind a spring: as the measured motion shakes it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.support.errors import SimulationError
from spacerobot.support.jit import jit

Motion = tuple[np.ndarray, np.ndarray]
"""Displacement and rate, shape (T,) each."""


def hidden(
    mechanism: Mechanism, acceleration: Mapping[str, np.ndarray], step: float, rested: Collection[str] = ()
) -> dict[str, Motion]:
    """Motion of every coordinate without a measured one, beside what carries it; by coordinate.

    x'' + (c / m) x' + (k / m) x = -a, from where the first acceleration would hold it still, or undeflected. Between
    two samples the acceleration is the cubic through the four about them, and the motion is exact: joined by lines,
    seven samples a cycle would lack 6 % of a resonance.

    Args:
        mechanism: whose coordinates ride on others by linear springs and dampers.
        acceleration: measured, by coordinate, shape (T,) [m/s^2 or rad/s^2].
        step: from sample to sample [s].
        rested: those that begin undeflected.

    Raises:
        SimulationError: one does not ride on a measured one, or not by linear springs and dampers.
    """
    found = {}
    for name, coordinate in mechanism.coordinates.items():
        if name in acceleration or name not in mechanism.ports:
            continue
        own = [f for f in mechanism.forces if name in mechanism.ports[f.port]]
        linear = all(f.kernel in (SPRING, DAMPER) and (f.sense or f.port) == f.port == name for f in own)
        shakes = acceleration.get(coordinate.carrier or "")
        if shakes is None or not linear:
            raise SimulationError(f"{name} has no measured motion")
        spring, damper = (sum(f.p[0] for f in own if f.kernel is law) / coordinate.mass for law in (SPRING, DAMPER))
        held = -shakes[0] / spring if spring and name not in rested else 0.0
        found[name] = _shaken(spring, damper, shakes, step, float(held))
    return found


def _shaken(spring: float, damper: float, acceleration: np.ndarray, step: float, begins: float) -> Motion:
    from scipy.linalg import expm

    # the state, the acceleration and its derivatives within a step, counted in steps, as one linear system
    system = np.zeros((6, 6))
    system[:2, :3] = [0.0, step, 0.0], [-spring * step, -damper * step, -step]
    system[2:5, 3:] = np.eye(3)
    out = np.empty((acceleration.size, 2))
    out[0] = begins, 0.0
    _stepped(expm(system), acceleration, out)
    return out[:, 0].copy(), out[:, 1].copy()


@jit
def _stepped(over: Any, a: Any, out: Any) -> None:
    last = a.size - 1
    for i in range(last):
        q, r = a[i], a[i + 1]
        p, s = a[max(i - 1, 0)], a[min(i + 2, last)]
        first = r - p / 3.0 - q / 2.0 - s / 6.0
        second, third = p - 2.0 * q + r, s - p + 3.0 * (q - r)
        for k in range(2):
            out[i + 1, k] = over[k, 0] * out[i, 0] + over[k, 1] * out[i, 1] + over[k, 2] * q
            out[i + 1, k] += over[k, 3] * first + over[k, 4] * second + over[k, 5] * third
