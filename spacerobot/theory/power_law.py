"""An undamped contact F = k d^n between a mass and a wall; n = 3/2 is Hertz.

Source: energy balance; the duration is the Beta integral int_0^1 du/sqrt(1 - u^(n+1)) (Landau and Lifshitz,
Theory of Elasticity, Sec. 9, for n = 3/2).
"""

from __future__ import annotations

import math

from spacerobot.theory.check import positive
from spacerobot.theory.special import gamma_ratio

HERTZ = 1.5


def peak_deflection(mass: float, stiffness: float, speed: float, exponent: float = HERTZ) -> float:
    """Largest penetration in m: ((n + 1) m v0^2/(2 k))^(1/(n + 1)).

    Args:
        mass: kg.
        stiffness: k, N/m^n.
        speed: of approach, m/s.
        exponent: n.
    """
    positive(mass=mass, stiffness=stiffness, speed=speed, exponent=exponent)
    return float((0.5 * (exponent + 1.0) * mass * speed**2 / stiffness) ** (1.0 / (exponent + 1.0)))


def peak_force(mass: float, stiffness: float, speed: float, exponent: float = HERTZ) -> float:
    """Largest force in N."""
    return float(stiffness * peak_deflection(mass, stiffness, speed, exponent) ** exponent)


def contact_time(mass: float, stiffness: float, speed: float, exponent: float = HERTZ) -> float:
    """Duration in s: 2 sqrt(pi) Gamma(1 + 1/(n + 1))/Gamma(1/2 + 1/(n + 1)) x_max/v0.

    For n = 3/2 that is 2.9433 x_max/v0 and falls with the speed like v0^(-1/5); only for n = 1 is it
    independent.
    """
    x_max = peak_deflection(mass, stiffness, speed, exponent)
    part = 1.0 / (exponent + 1.0)
    return 2.0 * math.sqrt(math.pi) * gamma_ratio(1.0 + part, 0.5 + part) * x_max / speed
