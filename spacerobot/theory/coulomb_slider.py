"""A mass on a spring (and dashpot) in a guide with Coulomb friction: restitution that depends on the speed.

    m x'' + c x' + k x + F sign(x') = 0,   x(0) = 0,  x'(0) = v0,   phi = F/(v0 sqrt(k m)).

With a constant equivalent damping the restitution would be one number; here it falls with falling speed, and
below a certain speed the mass does not come back at all. Both end conditions of `kelvin_voigt` apply: with
"force_zero" the force meant is the one that decelerates the mass, spring, dashpot and friction together, for
that is what a target that lies against a (massless) slider feels.

Source: piecewise integration of the equation above; zeta < 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from spacerobot.theory.check import not_negative, positive
from spacerobot.theory.kelvin_voigt import ENDS, End, damping_ratio, natural_frequency
from spacerobot.theory.roots import bracketed_root


@dataclass(frozen=True)
class Rebound:
    """What a hit comes to.

    Attributes:
        peak_deflection: X, m.
        compression_time: t1, s.
        contact_time: s; infinite if the mass stays.
        restitution: speed after over speed before; zero if the mass stays.
    """

    peak_deflection: float
    compression_time: float
    contact_time: float
    restitution: float


def friction_number(mass: float, stiffness: float, friction: float, speed: float) -> float:
    """phi = F/(v0 sqrt(k m))."""
    positive(mass=mass, stiffness=stiffness, speed=speed)
    not_negative(friction=friction)
    return friction / (speed * math.sqrt(stiffness * mass))


def rebound(
    mass: float,
    stiffness: float,
    friction: float,
    speed: float,
    *,
    damping: float = 0.0,
    end: End = "displacement_zero",
) -> Rebound:
    """Peak, duration and restitution of a hit.

    Compression: t1 = theta/omega_d with theta = atan2(sqrt(1 - zeta^2), zeta + phi), and
    X = (v0/omega0)(sqrt(1 + 2 zeta phi + phi^2) exp(-zeta theta/sqrt(1 - zeta^2)) - phi). The return from
    rest at X ends, force_zero: after acos(zeta)/omega_d; displacement_zero: at the root of a scalar equation.

    Args:
        mass: m, kg.
        stiffness: k, N/m.
        friction: F, N, the same at rest and in motion.
        speed: v0, m/s.
        damping: c, N s/m.
        end: the end condition.

    Raises:
        ValueError: a value out of range, an unknown end, or zeta >= 1.
    """
    if end not in ENDS:
        raise ValueError(f"end must be one of {ENDS}; given: {end!r}")
    phi = friction_number(mass, stiffness, friction, speed)
    zeta, omega0 = damping_ratio(mass, stiffness, damping), natural_frequency(mass, stiffness)
    if zeta >= 1:
        raise ValueError(f"the closed form is for a damping ratio below 1; given: {zeta!r}")
    root = math.sqrt(1.0 - zeta * zeta)
    theta = math.atan2(root, zeta + phi)
    x = math.sqrt(1.0 + 2.0 * zeta * phi + phi * phi) * math.exp(-zeta * theta / root) - phi  # X omega0/v0
    rest = x - phi  # distance from the point where spring and friction balance, in the same unit
    peak, t1 = x * speed / omega0, theta / (omega0 * root)
    if end == "force_zero":
        if rest <= 0:
            return Rebound(peak, t1, math.inf, 0.0)
        angle = math.acos(zeta)
        return Rebound(peak, t1, t1 + angle / (omega0 * root), rest * math.exp(-zeta * angle / root))

    def position(angle: float) -> float:
        decay = math.exp(-zeta * angle / root)
        return phi + rest * decay * (math.cos(angle) + zeta / root * math.sin(angle))

    if rest <= 0 or position(math.pi) > 0:
        return Rebound(peak, t1, math.inf, 0.0)
    angle = bracketed_root(position, math.acos(zeta), math.pi)
    speed_back = rest / root * math.exp(-zeta * angle / root) * math.sin(angle)
    return Rebound(peak, t1, t1 + angle / (omega0 * root), speed_back)


def restitution_undamped(phi: float, end: End = "displacement_zero") -> float:
    """e for c = 0.

    displacement_zero: e^2 = 1 - 4 phi (sqrt(1 + phi^2) - phi), zero from phi = 1/(2 sqrt 2) on;
    force_zero: e = sqrt(1 + phi^2) - 2 phi, zero from phi = 1/sqrt 3 on.
    """
    not_negative(phi=phi)
    root = math.hypot(1.0, phi)
    if end == "force_zero":
        return max(root - 2.0 * phi, 0.0)
    return math.sqrt(max(1.0 - 4.0 * phi * (root - phi), 0.0))


def smallest_speed(mass: float, stiffness: float, friction: float, end: End = "displacement_zero") -> float:
    """The speed in m/s below which nothing comes back, for c = 0.

    displacement_zero: 2 sqrt(2) F/sqrt(k m); force_zero: sqrt(3) F/sqrt(k m).
    """
    positive(mass=mass, stiffness=stiffness)
    not_negative(friction=friction)
    factor = math.sqrt(3.0) if end == "force_zero" else 2.0 * math.sqrt(2.0)
    return factor * friction / math.sqrt(stiffness * mass)


def equivalent_damping(friction: float, speed: float) -> float:
    """The damping that loses as much per cycle: c_eq = 4 F/(pi v), v the amplitude of the sliding speed.

    Friction takes 4 F X per cycle, a dashpot pi c v X. It holds at one speed only.
    """
    not_negative(friction=friction)
    positive(speed=speed)
    return 4.0 * friction / (math.pi * speed)


def equivalent_friction(damping: float, speed: float) -> float:
    """The Coulomb friction that a constant c_eq stands for at one speed: F = pi c_eq v/4, in N."""
    not_negative(damping=damping)
    positive(speed=speed)
    return math.pi * damping * speed / 4.0
