"""One mass on a spring and a dashpot: duration, restitution and peaks of a hit, under both end conditions.

m x'' + c x' + k x = 0 from x = 0 with speed v0; omega0 = sqrt(k/m), zeta = c/(2 sqrt(k m)).

* "displacement_zero": the hit ends when the spring is relaxed again (Eqs. 14, 16 and 18 of Uyama et al.
  2012). The force pulls before that end, so it takes a bilateral contact.
* "force_zero": it ends when the force first vanishes, as a contact that cannot pull ends (Schwager and
  Poeschel 2007, "Coefficient of restitution and linear-dashpot model revisited", Granular Matter 9).

All durations are in s, speeds in m/s, forces in N.
"""

from __future__ import annotations

import math
from typing import Literal

from spacerobot.theory.check import not_negative, positive
from spacerobot.theory.roots import bracketed_root

End = Literal["displacement_zero", "force_zero"]
ENDS: tuple[End, ...] = ("displacement_zero", "force_zero")


def damping_ratio(mass: float, stiffness: float, damping: float) -> float:
    """zeta = c/(2 sqrt(k m))."""
    positive(mass=mass, stiffness=stiffness)
    not_negative(damping=damping)
    return damping / (2.0 * math.sqrt(stiffness * mass))


def natural_frequency(mass: float, stiffness: float) -> float:
    """omega0 = sqrt(k/m) in rad/s."""
    positive(mass=mass, stiffness=stiffness)
    return math.sqrt(stiffness / mass)


def _angle_over_sine(zeta: float) -> float:
    """acos(zeta)/sqrt(1 - zeta^2), continued through zeta = 1: acosh(zeta)/sqrt(zeta^2 - 1)."""
    gap = 1.0 - zeta
    if abs(gap) < 1e-6:  # both numerator and denominator vanish: 1 + gap/3 + 2 gap^2/15 + ...
        return 1.0 + gap / 3.0 + 2.0 * gap * gap / 15.0
    if zeta < 1.0:
        return math.acos(zeta) / math.sqrt(1.0 - zeta * zeta)
    return math.acosh(zeta) / math.sqrt(zeta * zeta - 1.0)


def contact_time(mass: float, stiffness: float, damping: float, end: End = "displacement_zero") -> float:
    """Duration of the hit in s, whatever the speed.

    displacement_zero: pi/omega_d, infinite for zeta >= 1. force_zero: 2 acos(zeta)/(omega0 sqrt(1 - zeta^2)),
    continued for zeta >= 1.

    Raises:
        ValueError: unknown end, or a value out of range.
    """
    zeta, omega0 = damping_ratio(mass, stiffness, damping), natural_frequency(mass, stiffness)
    if _known(end) == "force_zero":
        return 2.0 * _angle_over_sine(zeta) / omega0
    return math.pi / (omega0 * math.sqrt(1.0 - zeta * zeta)) if zeta < 1.0 else math.inf


def restitution(mass: float, stiffness: float, damping: float, end: End = "displacement_zero") -> float:
    """Speed after the hit over speed before it, whatever the speed.

    displacement_zero: exp(-pi zeta/sqrt(1 - zeta^2)), zero for zeta >= 1. force_zero:
    exp(-2 zeta acos(zeta)/sqrt(1 - zeta^2)), continued for zeta >= 1.

    Raises:
        ValueError: unknown end, or a value out of range.
    """
    zeta = damping_ratio(mass, stiffness, damping)
    if _known(end) == "force_zero":
        return math.exp(-2.0 * zeta * _angle_over_sine(zeta))
    return math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta * zeta)) if zeta < 1.0 else 0.0


def damping_for_restitution(
    restitution_wanted: float, mass: float, stiffness: float, end: End = "displacement_zero"
) -> float:
    """The damping c in N s/m that gives a restitution; the inverse of `restitution`.

    Raises:
        ValueError: the restitution is not in (0, 1], or a value is out of range.
    """
    if not 0 < restitution_wanted <= 1:
        raise ValueError(f"restitution must lie in (0, 1]; given: {restitution_wanted!r}")
    positive(mass=mass, stiffness=stiffness)
    critical = 2.0 * math.sqrt(stiffness * mass)
    loss = -math.log(restitution_wanted)
    if _known(end) == "displacement_zero":
        return critical * loss / math.hypot(math.pi, loss)
    high = 1.0
    while 2.0 * high * _angle_over_sine(high) < loss:
        high *= 2.0
    return critical * bracketed_root(lambda z: 2.0 * z * _angle_over_sine(z) - loss, 0.0, high)


def peak_deflection(mass: float, stiffness: float, damping: float, speed: float) -> float:
    """Largest compression in m: (v0/omega0) exp(-zeta acos(zeta)/sqrt(1 - zeta^2))."""
    not_negative(speed=speed)
    zeta = damping_ratio(mass, stiffness, damping)
    return speed / natural_frequency(mass, stiffness) * math.exp(-zeta * _angle_over_sine(zeta))


def peak_force(mass: float, stiffness: float, damping: float, speed: float) -> float:
    """Largest force in N.

    zeta < 1/2: v0 sqrt(k m) exp(-(zeta/sqrt(1 - zeta^2)) (pi/2 - 3 asin(zeta))); above that the dashpot's c
    v0 at the first touch.
    """
    not_negative(speed=speed)
    zeta = damping_ratio(mass, stiffness, damping)
    if zeta >= 0.5:
        return damping * speed
    exponent = zeta / math.sqrt(1.0 - zeta * zeta) * (0.5 * math.pi - 3.0 * math.asin(zeta))
    return speed * math.sqrt(stiffness * mass) * math.exp(-exponent)


def _known(end: str) -> str:
    if end not in ENDS:
        raise ValueError(f"end must be one of {ENDS}; given: {end!r}")
    return end
