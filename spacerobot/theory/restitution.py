"""Eqs. 17 to 19: restitution, three ways to measure it, and the velocities after the hit.

    e = -(v_t' - v_h')/(v_t - v_h)                                   (Eq. 17, reconstructed)
    e = exp(-pi zeta/sqrt(1 - zeta^2))                               (Eq. 18)
    v' = v_cm +- (mass of the other)/(M + m) e (v_t - v_h)           (Eq. 19, reconstructed)

Primes: after the hit. Eq. 18 belongs to the end of Eq. 14; a contact that cannot pull has
exp(-2 zeta acos(zeta)/sqrt(1 - zeta^2)) instead.
"""

from __future__ import annotations

from dataclasses import dataclass

from spacerobot.theory import kelvin_voigt
from spacerobot.theory.check import mass_or_locked, positive
from spacerobot.theory.kelvin_voigt import End
from spacerobot.theory.reduction import Reduced


@dataclass(frozen=True)
class Measured:
    """Restitution the three ways that differ where M is finite.

    Attributes:
        target: of the target alone, -v_t'/v_t in the frame in which the hand was at rest.
        hand: target against hand, Eq. 17.
        point: at the contact point, target against wrist.
    """

    target: float
    hand: float
    point: float


def measured(before: tuple[float, float, float], after: tuple[float, float, float]) -> Measured:
    """Restitution from velocities.

    Args:
        before: of hand, wrist and target before the hit, m/s.
        after: the same after it.

    Raises:
        ValueError: the target did not approach hand or wrist.
    """
    hand, wrist, target = before
    if not (target > hand and target > wrist):
        raise ValueError(f"the target must approach: velocities of hand, wrist, target were {before!r} m/s")
    return Measured(
        target=-(after[2] - hand) / (target - hand),
        hand=-(after[2] - after[0]) / (target - hand),
        point=-(after[2] - after[1]) / (target - wrist),
    )


def displacement_zero(model: Reduced) -> float:
    """Eq. 18; zero from critical damping on."""
    return restitution(model, "displacement_zero")


def force_zero(model: Reduced) -> float:
    """The same with the end at the first zero of the force."""
    return restitution(model, "force_zero")


def restitution(model: Reduced, end: End = "displacement_zero") -> float:
    """Restitution of target against hand under either end condition."""
    return kelvin_voigt.restitution(model.mass, model.stiffness, model.damping, end)


def velocities_after(
    hand_mass: float, lumped_mass: float, hand_velocity: float, target_velocity: float, e: float
) -> tuple[float, float]:
    """Eq. 19: velocities of hand and target after the hit, from momentum and restitution, m/s.

    Args:
        hand_mass: M, kg; infinite for a locked arm.
        lumped_mass: m_w + m_t, kg.
        hand_velocity: before, m/s.
        target_velocity: before, m/s.
        e: restitution of target against hand.
    """
    mass_or_locked(hand_mass=hand_mass)
    positive(lumped_mass=lumped_mass)
    target_share = 1.0 / (1.0 + lumped_mass / hand_mass)  # M/(M + m), 1 for a locked arm
    approach = target_velocity - hand_velocity
    center = hand_velocity + (1.0 - target_share) * approach
    return center + (1.0 - target_share) * e * approach, center - target_share * e * approach
