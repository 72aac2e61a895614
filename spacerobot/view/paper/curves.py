"""Theory curves of Figs. 5 and 6: contact time and restitution over m_w + m_t, for the springs of Table 1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacerobot.theory import contact_time, restitution, table1
from spacerobot.theory.exact import solve

Array = NDArray[np.float64]

LUMPED_MASSES = np.linspace(5.0, 60.0, 45)
"""m_w + m_t of the curves, kg."""


@dataclass(frozen=True)
class Curve:
    """One spring. All arrays over `lumped_mass`, shape (n,).

    Attributes:
        stiffness: k_w, N/m.
        lumped_mass: m_w + m_t, kg.
        time_simplified: Eq. 16 with c_w + c_eq, s.
        time_released: the same with the contact ending where its force vanishes, s.
        time_exact: Eqs. 2 to 4, contact that cannot pull, first touch to last separation, s.
        e_wrist: Eq. 18 with c_w alone.
        e_simplified: Eq. 18 with c_w + c_eq.
        e_released: that with the contact ending where its force vanishes.
        e_exact: Eqs. 2 to 4 with c_w + c_eq, of the target.
    """

    stiffness: float
    lumped_mass: Array
    time_simplified: Array
    time_released: Array
    time_exact: Array
    e_wrist: Array
    e_simplified: Array
    e_released: Array
    e_exact: Array


def curve(spring: table1.Spring, equivalent_damping: float, lumped_masses: Array = LUMPED_MASSES) -> Curve:
    """Contact time and restitution of one spring, from the simplified and from the exact model."""
    rows = []
    for mass in lumped_masses:
        plain = table1.reduced(spring, float(mass), damping="wrist")
        full = table1.reduced(spring, float(mass), equivalent_damping=equivalent_damping)
        system = table1.three_masses(spring, float(mass) - table1.WRIST_MASS, equivalent_damping=equivalent_damping)
        motion = solve(system, spring.hand_speed)
        rows.append(
            (
                contact_time.displacement_zero(full),
                contact_time.force_zero(full),
                motion.contact_time,
                restitution.displacement_zero(plain),
                restitution.displacement_zero(full),
                restitution.force_zero(full),
                -float(motion.state(motion.end)[5]) / spring.hand_speed,
            )
        )
    return Curve(spring.stiffness, lumped_masses, *np.array(rows).T)
