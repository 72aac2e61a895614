"""Eqs. 1 to 4: the equivalent mass at the hand, and three masses in a row (hand, wrist, target).

All x point along the target's direction of motion and count from the first touch with the wrist at rest, so
that

    wrist deflection  s = x_w - x_h   (positive pushed in),
    penetration       d = x_t - x_w   (positive in contact),
    contact force     F = k_c d + c_c d'  (positive in compression),

    M   x_h'' =  k_w s + c s' + f               (Eq. 2)
    m_w x_w'' = -k_w s - c s' - f + F           (Eq. 3)
    m_t x_t'' = -F                              (Eq. 4)

with c = c_w, or c_w + c_eq where guide friction is read as damping. f is Coulomb friction of the guide, which
the paper does not have in its equations (there c_eq stands for it); it is zero unless asked for.

Source: Uyama et al. 2012. Eqs. 2 to 4 are the paper's; Eq. 1 is reconstructed (see `equations`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacerobot.theory.check import mass_or_locked, not_negative, positive

Row = NDArray[np.float64]


def equivalent_mass(
    inertia: NDArray[np.float64], jacobian: NDArray[np.float64], direction: NDArray[np.float64]
) -> float:
    """Eq. 1: the mass that a robot shows at its hand, M = 1/(n^T J H^-1 J^T n).

    Args:
        inertia: joint-space inertia H, shape (n, n), SI.
        jacobian: translational Jacobian J of the hand, shape (3, n), in the frame of `direction`.
        direction: unit vector n, shape (3,).

    Returns:
        M in kg; infinite where no joint can move the hand along the direction.

    Raises:
        ValueError: the direction is not a unit vector.
    """
    if abs(float(np.linalg.norm(direction)) - 1.0) > 1e-9:
        raise ValueError(f"direction must have length 1; given: {direction!r}")
    row = direction @ jacobian
    mobility = float(row @ np.linalg.solve(inertia, row))
    return 1.0 / mobility if mobility > 0 else float("inf")


@dataclass(frozen=True)
class ThreeMasses:
    """Hand, wrist and target of Eqs. 2 to 4.

    Attributes:
        hand_mass: M, kg; infinite for a locked arm.
        wrist_mass: m_w, kg.
        target_mass: m_t, kg.
        wrist_stiffness: k_w, N/m.
        wrist_damping: c, N s/m: c_w, or c_w + c_eq.
        contact_stiffness: k_c, N/m.
        contact_damping: c_c, N s/m.
        guide_friction: Coulomb friction in the wrist's guide, N.
    """

    hand_mass: float
    wrist_mass: float
    target_mass: float
    wrist_stiffness: float
    wrist_damping: float
    contact_stiffness: float
    contact_damping: float = 0.0
    guide_friction: float = 0.0

    def __post_init__(self) -> None:
        mass_or_locked(hand_mass=self.hand_mass)
        positive(wrist_mass=self.wrist_mass, target_mass=self.target_mass)
        positive(wrist_stiffness=self.wrist_stiffness, contact_stiffness=self.contact_stiffness)
        not_negative(wrist_damping=self.wrist_damping, contact_damping=self.contact_damping)
        not_negative(guide_friction=self.guide_friction)

    @property
    def hand_mobility(self) -> float:
        """1/M in 1/kg; zero for a locked arm."""
        return 1.0 / self.hand_mass

    @property
    def wrist_force(self) -> Row:
        """Row that gives k_w s + c s' from (x_h, x_w, x_t, v_h, v_w, v_t), shape (6,)."""
        k, c = self.wrist_stiffness, self.wrist_damping
        return np.array([-k, k, 0.0, -c, c, 0.0])

    @property
    def contact_force(self) -> Row:
        """Row that gives k_c d + c_c d', shape (6,)."""
        k, c = self.contact_stiffness, self.contact_damping
        return np.array([0.0, -k, k, 0.0, -c, c])

    def holding_friction(self, touching: bool) -> Row:
        """Row that gives the friction which would keep the wrist stuck in its guide, shape (6,)."""
        share = 1.0 / (1.0 + self.wrist_mass * self.hand_mobility)
        return share * self.contact_force * touching - self.wrist_force

    def state_matrix(self, touching: bool = True, stuck: bool = False) -> NDArray[np.float64]:
        """A of z' = A z with z = (x_h, x_w, x_t, v_h, v_w, v_t), sliding friction left out.

        Args:
            touching: the contact spring acts (both ways).
            stuck: the wrist is held to the hand by friction.

        Returns:
            A, shape (6, 6).
        """
        wrist = self.wrist_force + (self.holding_friction(touching) if stuck else 0.0)
        contact = self.contact_force * touching
        a = np.zeros((6, 6))
        a[:3, 3:] = np.eye(3)
        a[3] = self.hand_mobility * wrist
        a[4] = (contact - wrist) / self.wrist_mass
        a[5] = -contact / self.target_mass
        return a

    def energy(self, state: NDArray[np.float64], touching: NDArray[np.bool_] | bool = True) -> Row:
        """Kinetic and elastic energy in J; the hand's share counts only where M is finite.

        Args:
            state: (x_h, x_w, x_t, v_h, v_w, v_t), shape (..., 6).
            touching: whether the contact spring holds energy, shape (...).
        """
        hand = self.hand_mass if np.isfinite(self.hand_mass) else 0.0
        masses = np.array([hand, self.wrist_mass, self.target_mass])
        kinetic = 0.5 * (state[..., 3:] ** 2) @ masses
        s = state[..., 1] - state[..., 0]
        d = state[..., 2] - state[..., 1]
        contact = 0.5 * self.contact_stiffness * d**2
        return np.asarray(kinetic + 0.5 * self.wrist_stiffness * s**2 + np.where(touching, contact, 0.0))
