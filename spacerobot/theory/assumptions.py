"""What the closed forms of Eqs. 16 and 18 rest on, and what breaking each assumption costs.

The paper lists eight assumptions. Their wording is not quoted here: these are the eight that the derivation
needs, in the order in which it needs them. `examine` breaks one at a time and says what that does to contact
time and restitution, against the reduced model with c_w + c_eq. The fifth is judged with the sixth and eighth
already broken, for in the exact motion they come together.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spacerobot.theory import coulomb_slider, frequencies, table1
from spacerobot.theory.contact_time import contact_time
from spacerobot.theory.exact import solve
from spacerobot.theory.reduction import Reduced, reduced_mass
from spacerobot.theory.restitution import restitution

JOINT_STIFFNESS = 1e5
"""Of the arm's joints, N m/rad: the order of magnitude that the paper gives."""

LEVER = 1.0
"""From the joint that gives way to the hand, m."""

OFFSET = 0.25
"""How far beside the target's centre the contact line passes, in radii of gyration."""

MASS_CHANGE = 0.1
"""Relative change of M within one contact."""

FREE_HAND_MASS = 10.0
"""M for which that change is judged, kg: an arm with free joints. A locked arm on the ground has none."""

HARDENING = 0.1
"""Cubic part of the spring's force at full deflection over its linear part."""


@dataclass(frozen=True)
class Assumption:
    """One assumption.

    Attributes:
        number: in the order of the derivation.
        says: what is taken to hold.
        broken_by: how it is broken to see what it costs.
        measure: what says how well it holds.
    """

    number: int
    says: str
    broken_by: str
    measure: str


ASSUMPTIONS = (
    Assumption(
        1,
        "The target is a point mass: the contact line passes through its centre of mass.",
        f"a hit {OFFSET:g} radii of gyration beside the centre",
        "effective over whole target mass",
    ),
    Assumption(
        2,
        "The robot is one constant mass M at its hand, along one line.",
        f"M changes by {MASS_CHANGE:.0%} during the contact, at M = {FREE_HAND_MASS:g} kg",
        "share of M in the reduced mass, (m_w + m_t)/(M + m_w + m_t)",
    ),
    Assumption(
        3,
        "The joints do not give way: they are far stiffer than the wrist.",
        f"joints of {JOINT_STIFFNESS:.0e} N m/rad at {LEVER:g} m from the hand, in series with the wrist",
        "arm stiffness at the hand over wrist stiffness",
    ),
    Assumption(
        4,
        "The wrist's spring and dashpot are linear.",
        f"a spring {HARDENING:.0%} above its line at full deflection",
        "cubic over linear force at full deflection",
    ),
    Assumption(
        5,
        "The contact is much stiffer than the wrist: omega_c is far above omega_w.",
        "Eqs. 2 to 4 solved exactly, with the contact's own spring and damper",
        "omega_c/omega_w of Eqs. 6 and 7",
    ),
    Assumption(
        6,
        "The wrist is much lighter than the target.",
        "the target has to bring the resting wrist up to its own speed first",
        "m_w/m_t",
    ),
    Assumption(
        7,
        "Friction in the guide acts like a constant damping c_eq.",
        "Coulomb friction F = pi c_eq v/4 of the mean speed, met at half that speed",
        "friction number F/(v sqrt(k m)) at the mean speed",
    ),
    Assumption(
        8,
        "The contact lasts, unbroken, until the deflection is back at zero (Eq. 14).",
        "the contact ends where its force vanishes, as one that cannot pull must",
        "share of the contact time in which the force would pull",
    ),
)


@dataclass(frozen=True)
class Finding:
    """How well one assumption holds in one condition, and the cost of breaking it.

    Attributes:
        number: of the assumption.
        measure: the value of its measure.
        contact_time: relative change of the contact time, +0.01 for 1 % longer.
        restitution: change of the restitution.
    """

    number: int
    measure: float
    contact_time: float
    restitution: float


def examine(
    spring: table1.Spring, target_mass: float, *, equivalent_damping: float = table1.EQUIVALENT_DAMPING
) -> tuple[Finding, ...]:
    """Break the eight assumptions one at a time in one condition of Table 1.

    Args:
        spring: the wrist's spring.
        target_mass: m_t, kg.
        equivalent_damping: c_eq, N s/m.

    Returns:
        One finding for each assumption, in order.
    """
    speed = spring.hand_speed
    base = table1.reduced(spring, table1.WRIST_MASS + target_mass, equivalent_damping=equivalent_damping)
    tau, e = contact_time(base), restitution(base)

    def cost(number: int, measure: float, model: Reduced) -> Finding:
        return Finding(number, measure, contact_time(model) / tau - 1.0, restitution(model) - e)

    share = 1.0 / (1.0 + OFFSET**2)
    eccentric = Reduced(table1.WRIST_MASS + target_mass * share, base.stiffness, base.damping)
    point = Finding(1, share, contact_time(eccentric) / tau - 1.0, (1 + restitution(eccentric)) * share - 1 - e)

    lumped = table1.WRIST_MASS + target_mass
    free, changed = (
        Reduced(reduced_mass(mass, lumped), base.stiffness, base.damping)
        for mass in (FREE_HAND_MASS, FREE_HAND_MASS * (1 + MASS_CHANGE))
    )
    hand = Finding(
        2,
        lumped / (FREE_HAND_MASS + lumped),
        contact_time(changed) / contact_time(free) - 1.0,
        restitution(changed) - restitution(free),
    )

    arm = JOINT_STIFFNESS / LEVER**2
    series = Reduced(base.mass, base.stiffness / (1.0 + base.stiffness / arm), base.damping)

    angle = (np.arange(64) + 0.5) * math.pi / 128  # midpoint rule on a periodic integrand: exact to rounding
    hardened = float(np.mean(1.0 / np.sqrt(1.0 + 0.5 * HARDENING * (1.0 + np.sin(angle) ** 2))))
    zeta = base.damping_ratio / math.sqrt(1.0 + 0.75 * HARDENING)  # at the mean stiffness over the deflection

    system = table1.three_masses(spring, target_mass, equivalent_damping=equivalent_damping)
    motion = solve(system, speed)
    rebound = -float(motion.state(motion.end)[5]) / speed
    accelerated = target_mass / lumped  # what is left of the speed once the wrist moves along

    friction = coulomb_slider.equivalent_friction(equivalent_damping, speed)
    slow = coulomb_slider.rebound(base.mass, base.stiffness, friction, 0.5 * speed, damping=spring.damping)
    phi = coulomb_slider.friction_number(base.mass, base.stiffness, friction, speed)

    released, e_released = contact_time(base, "force_zero"), restitution(base, "force_zero")
    return (
        point,
        hand,
        cost(3, arm / base.stiffness, series),
        Finding(4, HARDENING, hardened - 1.0, math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2)) - e),
        Finding(
            5,
            frequencies.frequency_ratio(system),
            motion.contact_time / released - 1.0,
            rebound - accelerated * e_released,
        ),
        Finding(6, table1.WRIST_MASS / target_mass, 0.0, (accelerated - 1.0) * e),
        Finding(7, phi, slow.contact_time / tau - 1.0, slow.restitution - e),
        Finding(8, 1.0 - released / tau, released / tau - 1.0, e_released - e),
    )
