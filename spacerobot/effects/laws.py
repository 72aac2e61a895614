"""The laws of a plain rig: linear spring, linear damper, and the spring-dashpot contact."""

from __future__ import annotations

from typing import Any

from spacerobot.effects.kernel import Kernel

REFERENCE_PENETRATION = 1e-3
"""Penetration [m] at which a power-law contact has the force of the linear one."""


def spring_force(d: float, v: float, aux: float, p: Any) -> float:
    """-k d; p = (k,)."""
    return -p[0] * d


def spring_energy(d: float, v: float, aux: float, p: Any) -> float:
    """k d^2 / 2."""
    return 0.5 * p[0] * d * d


def damper_force(d: float, v: float, aux: float, p: Any) -> float:
    """-c v; p = (c,)."""
    return -p[0] * v


def contact_force(d: float, v: float, aux: float, p: Any) -> float:
    """Spring and damper in the contact.

    -(k d_ref (d/d_ref)^n (1 + chi v) + c v) with p = (k, c, n, chi), d_ref = 1 mm; odd in d, so that an adhesive
    contact pulls. n = 1, chi = 0 is Kelvin-Voigt; n = 1.5 Hertz; chi > 0 Hunt and Crossley (1975).
    """
    k, c, n, chi = p[0], p[1], p[2], p[3]
    if n == 1.0:
        elastic = k * d
    elif d >= 0.0:
        elastic = k * 1e-3 * (d / 1e-3) ** n
    else:
        elastic = -k * 1e-3 * (-d / 1e-3) ** n
    return -(elastic * (1.0 + chi * v) + c * v)


def contact_energy(d: float, v: float, aux: float, p: Any) -> float:
    """Integral of the elastic part over d."""
    k, n = p[0], p[2]
    return k * 1e-6 * (abs(d) / 1e-3) ** (n + 1.0) / (n + 1.0)


SPRING = Kernel(spring_force, energy=spring_energy)
DAMPER = Kernel(damper_force)
CONTACT = Kernel(contact_force, energy=contact_energy)
