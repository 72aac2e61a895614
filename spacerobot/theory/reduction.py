"""Eqs. 9 to 11: one mass on one spring in place of three masses on two.

With the contact spring much stiffer than the wrist's, wrist and target move as one; what remains is their
motion against the hand, a mass

    m~ = M (m_w + m_t)/(M + m_w + m_t)     (Eq. 10)

on the wrist spring, omega = sqrt(k_w/m~) (Eq. 9). For a locked arm M is infinite and m~ = m_w + m_t. Eq. 11
(reconstructed) is its equation of motion, m~ x'' + c x' + k_w x = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from spacerobot.theory.check import mass_or_locked, not_negative, positive
from spacerobot.theory.equations_of_motion import ThreeMasses

Damping = Literal["wrist", "wrist+equivalent"]
DAMPINGS: tuple[Damping, ...] = ("wrist", "wrist+equivalent")


def reduced_mass(hand_mass: float, lumped_mass: float) -> float:
    """Eq. 10: m~ = M (m_w + m_t)/(M + m_w + m_t), in kg.

    Args:
        hand_mass: M, kg; infinite for a locked arm.
        lumped_mass: m_w + m_t, kg.
    """
    mass_or_locked(hand_mass=hand_mass)
    positive(lumped_mass=lumped_mass)
    return lumped_mass / (1.0 + lumped_mass / hand_mass)


def reduced_frequency(stiffness: float, mass: float) -> float:
    """Eq. 9: omega = sqrt(k_w/m~), rad/s."""
    positive(stiffness=stiffness, mass=mass)
    return math.sqrt(stiffness / mass)


def total_damping(wrist: float, equivalent: float, reading: Damping) -> float:
    """The damping c of the reduced model: c_w alone, or c_w + c_eq with the guide's friction read as damping.

    At 530 N/m and 9.7 kg the first reading gives a restitution of 0.97, the second 0.74.

    Raises:
        ValueError: unknown reading, or a negative damping.
    """
    not_negative(wrist=wrist, equivalent=equivalent)
    if reading not in DAMPINGS:
        raise ValueError(f"the damping's reading must be one of {DAMPINGS}; given: {reading!r}")
    return wrist if reading == "wrist" else wrist + equivalent


@dataclass(frozen=True)
class Reduced:
    """The reduced model of Eq. 11.

    Attributes:
        mass: m~, kg.
        stiffness: k_w, N/m.
        damping: c, N s/m.
    """

    mass: float
    stiffness: float
    damping: float

    def __post_init__(self) -> None:
        positive(mass=self.mass, stiffness=self.stiffness)
        not_negative(damping=self.damping)

    @property
    def frequency(self) -> float:
        """omega of Eq. 9, rad/s."""
        return reduced_frequency(self.stiffness, self.mass)

    @property
    def damping_ratio(self) -> float:
        """zeta = c/(2 sqrt(k_w m~))."""
        return self.damping / (2.0 * math.sqrt(self.stiffness * self.mass))

    @property
    def damped_frequency(self) -> float:
        """omega_d = omega sqrt(1 - zeta^2), rad/s.

        Raises:
            ValueError: the model is not underdamped.
        """
        if self.damping_ratio >= 1:
            raise ValueError(f"no oscillation: the damping ratio is {self.damping_ratio!r}, valid is below 1")
        return self.frequency * math.sqrt(1.0 - self.damping_ratio**2)


def reduce(system: ThreeMasses) -> Reduced:
    """The reduced model of three masses (their contact spring and guide friction are dropped)."""
    mass = reduced_mass(system.hand_mass, system.wrist_mass + system.target_mass)
    return Reduced(mass, system.wrist_stiffness, system.wrist_damping)
