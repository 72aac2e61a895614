"""Restitution of the Hunt-Crossley contact F = k d^n + chi d^n d', exactly, both ways.

With s = chi v0/k the restitution e depends on s alone, whatever n, k and the mass:

    s (1 + e) = ln((1 + s)/(1 - e s)),   e = (1 + W0(-(1 + s) exp(-(1 + s))))/s.

Source: Hunt and Crossley 1975, "Coefficient of restitution interpreted as damping in vibroimpact", integrated
exactly over the velocity (their own law, and the many others in use, are approximations of this inverse).
"""

from __future__ import annotations

import math

from spacerobot.theory.check import not_negative, positive
from spacerobot.theory.roots import bracketed_root
from spacerobot.theory.special import lambert_w0

_SMALL = 0.05


def restitution(dissipation: float, stiffness: float, speed: float) -> float:
    """Speed of separation over speed of approach.

    Args:
        dissipation: chi, N s/m^(n+1).
        stiffness: k, N/m^n.
        speed: of approach, m/s.

    Returns:
        e in (0, 1].
    """
    positive(stiffness=stiffness)
    not_negative(dissipation=dissipation, speed=speed)
    return restitution_of(dissipation * speed / stiffness)


def restitution_of(s: float) -> float:
    """e of s = chi v0/k.

    Below s = 0.05 the Lambert form loses its digits to cancellation (at s = 1e-6 it gives e > 1); there the
    implicit equation, divided by s^2 and written as a series, is solved instead: e = 1 - 2 s/3 + ...
    """
    not_negative(s=s)
    if s >= _SMALL:
        return (1.0 + lambert_w0(-(1.0 + s) * math.exp(-(1.0 + s)))) / s
    return bracketed_root(lambda e: _balance(s, e), 0.0, 1.0) if s > 0 else 1.0


def dissipation_ratio(restitution_wanted: float) -> float:
    """s = chi v0/k that gives a restitution; zero for 1, infinite for 0.

    Raises:
        ValueError: the restitution is not in [0, 1].
    """
    e = restitution_wanted
    if not 0 <= e <= 1:
        raise ValueError(f"restitution must lie in [0, 1]; given: {e!r}")
    if e == 1:
        return 0.0
    if e < 1e-300:
        return math.inf
    if e >= 0.05:
        return bracketed_root(lambda s: _balance(s, e), 0.0, (1.0 - 1e-12) / e)
    s = 1.0 / e  # there 1 - e s = (1 + s) exp(-s (1 + e)) is tiny: each fixed-point step gains digits
    for _ in range(40):
        s = (1.0 - (1.0 + s) * math.exp(-s * (1.0 + e))) / e
    return s


def dissipation_for(restitution_wanted: float, stiffness: float, speed: float) -> float:
    """chi that gives a restitution at a speed of approach; N s/m^(n+1)."""
    positive(stiffness=stiffness, speed=speed)
    return dissipation_ratio(restitution_wanted) * stiffness / speed


def _balance(s: float, e: float) -> float:
    """(-ln(1 - e s) - e s)/s^2 - (s - ln(1 + s))/s^2; zero at the solution, rising in both arguments."""
    if max(e * s, s) < _SMALL:
        return math.fsum((e**k - (-1.0) ** k) * s ** (k - 2) / k for k in range(2, 16))
    return (-math.log1p(-e * s) - e * s - s + math.log1p(s)) / (s * s)
