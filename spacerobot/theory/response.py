"""Eqs. 12 to 15: the response of the reduced model to a hit, its end, and what the force does before that
end.

    x(t)  = (v0/omega_d) exp(-zeta omega t) sin(omega_d t)                                  (Eq. 12)
    x'(t) = v0 exp(-zeta omega t) (cos omega_d t - zeta/sqrt(1 - zeta^2) sin omega_d t)     (Eq. 13)
    x(tau) = 0, tau > 0                                                                     (Eq. 14)
    omega_d tau = pi                                                                        (Eq. 15)

Eq. 14 is the paper's end condition; the numbers of the others are reconstructed. With damping, the force that
the target feels, k_w x + c x', changes sign before tau: from `contact_time.force_zero` on to tau a contact
that fulfils Eq. 14 pulls at the target, which two bodies that merely touch cannot do. `adhesion` says how
long and how hard.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacerobot.theory import kelvin_voigt
from spacerobot.theory.check import positive
from spacerobot.theory.reduction import Reduced

Array = NDArray[np.float64]


def displacement(model: Reduced, speed: float, time: float | Array) -> Array:
    """Eq. 12: wrist deflection in m at `time` in s (same shape), for a hit at `speed` in m/s."""
    return speed / model.damped_frequency * _phase(model, time, 0)


def velocity(model: Reduced, speed: float, time: float | Array) -> Array:
    """Eq. 13: rate of the deflection in m/s at `time` in s (same shape)."""
    return speed * model.frequency / model.damped_frequency * _phase(model, time, 1)


def force(model: Reduced, speed: float, time: float | Array) -> Array:
    """k_w x + c x' in N at `time` in s (same shape): what decelerates the target; negative where it pulls."""
    factor = speed * model.frequency**2 / model.damped_frequency
    return -model.mass * factor * _phase(model, time, 2)


def end_angle() -> float:
    """Eq. 15: the first positive root of Eq. 14 as an angle omega_d tau, which is pi."""
    return math.pi


@dataclass(frozen=True)
class Adhesion:
    """How a contact that lasts until Eq. 14 would have to pull.

    Attributes:
        start: when the force turns negative, s.
        end: the end of Eq. 14, s.
        share: (end - start)/end.
        peak_force: the strongest pull, N, positive.
        peak_share: that over the strongest push.
    """

    start: float
    end: float
    share: float
    peak_force: float
    peak_share: float


def adhesion(model: Reduced, speed: float) -> Adhesion:
    """The pull before the end of Eq. 14; it is there whenever there is damping."""
    positive(speed=speed)
    parts = (model.mass, model.stiffness, model.damping)
    start = kelvin_voigt.contact_time(*parts, "force_zero")
    end = kelvin_voigt.contact_time(*parts, "displacement_zero")
    # stationary points of the force: the third derivative of x vanishes
    angle = 3.0 * math.acos(model.damping_ratio)
    stationary = [(angle + j * math.pi) / model.damped_frequency for j in range(-3, 3)]
    times = [end, *(t for t in stationary if start < t < end)]
    pull = max(0.0, *(-float(force(model, speed, t)) for t in times))
    push = kelvin_voigt.peak_force(*parts, speed)
    return Adhesion(start, end, (end - start) / end, pull, pull / push)


def _phase(model: Reduced, time: float | Array, order: int) -> Array:
    """exp(-zeta omega t) sin(omega_d t + order (pi - acos zeta)); a derivative turns the phase by that."""
    t = np.asarray(time, dtype=float)
    turn = order * (math.pi - math.acos(model.damping_ratio))
    decay = np.exp(-model.damping_ratio * model.frequency * t)
    return np.asarray(decay * np.sin(model.damped_frequency * t + turn))
