"""Eq. 16: how long wrist and target stay in touch, in the reduced model.

    tau = pi/omega_d     (Eq. 16, from Eq. 14: the deflection is back at zero)

A contact that cannot pull lets go earlier, when the force vanishes: tau = 2 acos(zeta)/(omega sqrt(1 -
zeta^2)). Neither depends on the speed.
"""

from __future__ import annotations

from spacerobot.theory import kelvin_voigt
from spacerobot.theory.kelvin_voigt import End
from spacerobot.theory.reduction import Reduced


def displacement_zero(model: Reduced) -> float:
    """Eq. 16 in s; infinite from critical damping on."""
    return contact_time(model, "displacement_zero")


def force_zero(model: Reduced) -> float:
    """The same with the end at the first zero of the force, in s."""
    return contact_time(model, "force_zero")


def contact_time(model: Reduced, end: End = "displacement_zero") -> float:
    """The contact time in s under either end condition."""
    return kelvin_voigt.contact_time(model.mass, model.stiffness, model.damping, end)
