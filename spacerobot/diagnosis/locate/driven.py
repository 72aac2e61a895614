"""The motion that the model expects from the measured contact force: free of the position sensors' noise.

Patterns that a residual is tested against must not be made of the noise in that residual. So positions are split in
what the model, driven by the measured force, would do, and a remainder that is smoothed: where the model is right
the remainder is nothing (an instrument, as in Janot, Vandanjon and Gautier 2014, IEEE Trans. Control Syst. Technol.
22, Sec. III).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from spacerobot.diagnosis.locate.laws import linear_coefficients
from spacerobot.effects.mechanism import Mechanism


@dataclass(frozen=True, eq=False)
class Driven:
    """Expected motion of some coordinates from rest at the start. T times, n coordinates."""

    time: np.ndarray  # (T,) s
    names: tuple[str, ...]
    position: np.ndarray  # (n, T) m or rad
    rate: np.ndarray  # (n, T)
    acceleration: np.ndarray  # (n, T)

    def along(self, row: Mapping[str, float]) -> np.ndarray:
        """Position, rate and acceleration of a port with this row of coefficients, shape (3, T)."""
        x = np.array([row.get(n, 0.0) for n in self.names])
        if not self.names:
            return np.zeros((3, self.time.size))
        return np.stack([x @ self.position, x @ self.rate, x @ self.acceleration])


def driven(mechanism: Mechanism, time: np.ndarray, load: Mapping[str, np.ndarray]) -> Driven:
    """Motion under generalised forces `load` at `time`, linear in between, shape (T,) each.

    Springs and dampers of the mechanism act where their laws are linear; others are left to the remainder.
    """
    names = tuple(n for n in mechanism.coordinates if _wanted(mechanism, n, load))
    count = len(names)
    if not count:
        empty = np.zeros((0, time.size))
        return Driven(time, (), empty, empty, empty)
    mass = np.array([mechanism.coordinates[n].mass for n in names])
    stiffness, damping = np.zeros((count, count)), np.zeros((count, count))
    for force in mechanism.forces:
        linear = linear_coefficients(force.kernel, force.p) if any(force.p) and force.aux is None else None
        if linear is None:
            continue
        on = np.array([mechanism.ports[force.port].get(n, 0.0) for n in names])
        of = np.array([mechanism.ports[force.sense or force.port].get(n, 0.0) for n in names])
        stiffness += linear[0] * np.outer(on, of)
        damping += linear[1] * np.outer(on, of)
    system = np.block([[np.zeros((count, count)), np.eye(count)], [stiffness / mass[:, None], damping / mass[:, None]]])
    u = np.array([load.get(n, np.zeros(time.size)) for n in names]) / mass[:, None]
    state = _march(system, time, u)
    acceleration = system[count:] @ state + u
    return Driven(time, names, state[:count], state[count:], acceleration)


def _wanted(mechanism: Mechanism, name: str, load: Mapping[str, np.ndarray]) -> bool:
    """Whether a load reaches a coordinate, itself or through a port."""
    reached = set(load)
    for _ in mechanism.coordinates:
        for row in mechanism.ports.values():
            if reached & {n for n, x in row.items() if x}:
                reached |= {n for n, x in row.items() if x}
    return name in reached


def _march(system: np.ndarray, time: np.ndarray, u: np.ndarray) -> np.ndarray:
    """States shape (2 n, T) of y' = A y + (0, u), exact for u that is linear between the times."""
    size, count = system.shape[0], u.shape[0]
    state = np.zeros((size, time.size))
    steps = np.diff(time)
    kept: dict[float, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}
    y = np.zeros(size)
    drive = np.zeros((size, count))
    drive[count:] = np.eye(count)
    for k, step in enumerate(steps):
        key = round(float(step), 9)
        if key not in kept:
            block = np.zeros((size + 2 * count, size + 2 * count))
            block[:size, :size] = system * key
            block[:size, size : size + count] = drive * key
            block[size : size + count, size + count :] = np.eye(count)
            found = expm(block)
            late = found[:size, size + count :]
            kept[key] = found[:size, :size], found[:size, size : size + count] - late, late
        a, early, late = kept[key]
        y = a @ y + early @ u[:, k] + late @ u[:, k + 1]
        state[:, k + 1] = y
    return state
