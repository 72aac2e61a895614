"""Eqs. 5 to 8: the natural frequencies of hand, wrist and target in contact.

Eqs. 6 and 7 define the frequencies of the two springs taken alone,

    omega_c^2 = k_c (m_w + m_t)/(m_w m_t),   omega_w^2 = k_w (M + m_w)/(M m_w).

**Eq. 5 as printed does not give the frequencies of Eqs. 2 to 4.** For M = 1e9, m_w = 0.7, m_t = 9 kg, k_w =
530 and k_c = 68000 N/m its low branch is 19.8 rad/s; the eigenvalues of Eqs. 2 to 4 give 7.37, and Eqs. 9 and
10 give 7.39. Nor does Eq. 8 follow from Eq. 5. The characteristic polynomial of Eqs. 2 to 4 is

    w^4 - (omega_w^2 + omega_c^2) w^2 + omega_w^2 omega_c^2 X = 0,
    X = m_w (M + m_w + m_t)/((M + m_w)(m_w + m_t)),

and its low branch does tend to k_w/m~ with m~ of Eq. 10 as k_c grows. `exact` solves this polynomial;
`printed_reading` is a form that behaves as Eq. 5 is reported to, for comparison only. All frequencies are
undamped and in rad/s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from spacerobot.theory.equations_of_motion import ThreeMasses

PRINTED_LOW_BRANCH = 19.8
"""Low branch of Eq. 5 as printed for `PRINTED_CASE`, rad/s; the one number known of the print."""

PRINTED_CASE = ThreeMasses(1e9, 0.7, 9.0, 530.0, 0.0, 68000.0)
"""The case that `PRINTED_LOW_BRANCH` belongs to."""


@dataclass(frozen=True)
class Frequencies:
    """The two natural frequencies, rad/s: `low` of the wrist spring, `high` of the contact spring."""

    low: float
    high: float


def contact_frequency(system: ThreeMasses) -> float:
    """Eq. 6: omega_c, wrist and target on the contact spring, rad/s."""
    return math.sqrt(system.contact_stiffness * (1.0 / system.wrist_mass + 1.0 / system.target_mass))


def wrist_frequency(system: ThreeMasses) -> float:
    """Eq. 7: omega_w, hand and wrist on the wrist spring, rad/s."""
    return math.sqrt(system.wrist_stiffness * (system.hand_mobility + 1.0 / system.wrist_mass))


def frequency_ratio(system: ThreeMasses) -> float:
    """omega_c/omega_w, which the separation of the two motions takes to be large."""
    return contact_frequency(system) / wrist_frequency(system)


def coupling(system: ThreeMasses) -> float:
    """X of the characteristic polynomial, written in the hand's mobility so that M may be infinite."""
    w, t, mobility = system.wrist_mass, system.target_mass, system.hand_mobility
    return w * (1.0 + (w + t) * mobility) / ((1.0 + w * mobility) * (w + t))


def exact(system: ThreeMasses) -> Frequencies:
    """The natural frequencies of Eqs. 2 to 4, from their characteristic polynomial."""
    a, b = wrist_frequency(system) ** 2, contact_frequency(system) ** 2
    product = a * b * coupling(system)
    high = 0.5 * (a + b + math.sqrt((a + b) ** 2 - 4.0 * product))
    # product/high keeps the digits of the low branch, which the difference of the two roots would lose
    return Frequencies(math.sqrt(product / high), math.sqrt(high))


def separated(system: ThreeMasses) -> Frequencies:
    """Eq. 8: the limits of the two branches for omega_c much above omega_w.

    The low one is omega_w sqrt(X) = sqrt(k_w/m~), Eqs. 9 and 10; the high one is omega_c. It is the limit of
    `exact`, not of the print's Eq. 5.
    """
    return Frequencies(wrist_frequency(system) * math.sqrt(coupling(system)), contact_frequency(system))


def printed_reading(system: ThreeMasses) -> Frequencies:
    """A form with the reported low branch of the printed Eq. 5. Not the natural frequencies; do not design
    with it.

        w^2 = (omega_w^2 + omega_c^2)/2 -+ sqrt(omega_w^4 + omega_c^4 - X omega_w^2 omega_c^2)/2

    The print itself was not at hand; this is the exact form with the discriminant's product term reduced to
    what reproduces the one number known of it (`PRINTED_LOW_BRANCH`, to the 0.05 rad/s of its rounding).
    Other slips in the same term do so too, and agree with this one within 0.2 % over Table 1. What it shows
    does not depend on which: the low branch tends to about 0.7 omega_w as k_c grows, and not to sqrt(k_w/m~).
    """
    a, b = wrist_frequency(system) ** 2, contact_frequency(system) ** 2
    gap = math.sqrt(a * a + b * b - coupling(system) * a * b)
    low = ((a + b) ** 2 - gap * gap) / (2.0 * (a + b + gap))
    return Frequencies(math.sqrt(low), math.sqrt(0.5 * (a + b + gap)))
