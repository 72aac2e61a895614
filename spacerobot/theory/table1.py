"""Table 1: the rig of the paper, as data.

Springs, their damping, the masses and the contact stiffness are the paper's. What the source at hand does not
hold is marked as inferred: the equivalent damping of the guide, the speeds of the single springs, the contact
damping.
"""

from __future__ import annotations

from dataclasses import dataclass

from spacerobot.theory.equations_of_motion import ThreeMasses
from spacerobot.theory.reduction import Damping, Reduced, reduced_mass, total_damping


@dataclass(frozen=True)
class Spring:
    """One of the wrist's springs.

    Attributes:
        stiffness: k_w, N/m.
        damping: c_w, N s/m.
        hand_speed: mean speed of the hand in its trials, m/s.
    """

    stiffness: float
    damping: float
    hand_speed: float

    @property
    def label(self) -> str:
        """Such as "530 N/m"."""
        return f"{self.stiffness:g} N/m"


SPRINGS = (
    Spring(530.0, 1.4, 0.10),
    Spring(1020.0, 2.1, 0.10),
    Spring(3600.0, 2.8, 0.04),
    Spring(5100.0, 2.7, 0.04),
)
"""About 10 cm/s for the two soft springs and 7 over all four are the paper's; 4 for the stiff two follows."""

HAND_MASS = 1e9
"""M of the ground-locked arm, kg. 3e-8 (duration) and 1.3e-7 (velocity) from a locked one."""

WRIST_MASS = 0.7
"""m_w, kg."""

TARGET_MASSES = (9.0, 23.2, 51.0)
"""m_t, kg."""

CONTACT_STIFFNESS = 68000.0
"""k_c, N/m."""

CONTACT_DAMPING = 60.0
"""c_c, N s/m; inferred (a seventh of critical). With none the wrist rattles on the target."""

EQUIVALENT_DAMPING = 12.3
"""c_eq, N s/m; inferred: with c_w it makes 0.97 into the reported 0.74 at 530 N/m, 9.7 kg (Eq. 18)."""


def three_masses(
    spring: Spring,
    target_mass: float,
    *,
    damping: Damping = "wrist+equivalent",
    equivalent_damping: float = EQUIVALENT_DAMPING,
    hand_mass: float = HAND_MASS,
    guide_friction: float = 0.0,
) -> ThreeMasses:
    """Eqs. 2 to 4 for one condition of Table 1.

    Args:
        spring: one of `SPRINGS`, or another.
        target_mass: m_t, kg.
        damping: "wrist" for c_w, "wrist+equivalent" for c_w + c_eq.
        equivalent_damping: c_eq, N s/m.
        hand_mass: M, kg.
        guide_friction: Coulomb friction of the guide, N; put it in place of c_eq, not beside it.
    """
    return ThreeMasses(
        hand_mass=hand_mass,
        wrist_mass=WRIST_MASS,
        target_mass=target_mass,
        wrist_stiffness=spring.stiffness,
        wrist_damping=total_damping(spring.damping, equivalent_damping, damping),
        contact_stiffness=CONTACT_STIFFNESS,
        contact_damping=CONTACT_DAMPING,
        guide_friction=guide_friction,
    )


def reduced(
    spring: Spring,
    lumped_mass: float,
    *,
    damping: Damping = "wrist+equivalent",
    equivalent_damping: float = EQUIVALENT_DAMPING,
    hand_mass: float = HAND_MASS,
) -> Reduced:
    """The reduced model for one spring of Table 1 and m_w + m_t in kg."""
    c = total_damping(spring.damping, equivalent_damping, damping)
    return Reduced(reduced_mass(hand_mass, lumped_mass), spring.stiffness, c)
