"""The frequency of a soft contact, at which servo-held joints show their apparent mass."""

from __future__ import annotations

import math
from collections.abc import Callable

from spacerobot.support.errors import InputError


def reduced_mass(hand_mobility: float, tip_mass: float) -> float:
    """m~ = M (m_w + m_t)/(M + m_w + m_t) of Uyama et al. (2012), Eq. 10, written with 1/M so that M may be
    infinite.

    Args:
        hand_mobility: 1/M [1/kg], zero for a locked arm on the ground.
        tip_mass: m_w + m_t, wrist slider plus target [kg].
    """
    return 1.0 / (hand_mobility + 1.0 / tip_mass)


def contact_frequency(
    mobility: Callable[[float], complex], wrist_stiffness: float, tip_mass: float
) -> tuple[float, bool]:
    """Solve w = sqrt(k_w/m~(w)) where the hand's mass depends on w itself.

    A damped fixed-point iteration on w^2 = k_w (1/(m_w + m_t) + Re 1/m_app(w)), from the locked arm's
    frequency.

    Args:
        mobility: 1/m_app at an angular frequency [rad/s -> 1/kg].
        wrist_stiffness: k_w [N/m].
        tip_mass: m_w + m_t [kg].

    Returns:
        angular frequency [rad/s], and whether the iteration settled; if not, the locked arm's frequency.

    Raises:
        InputError: stiffness or mass not positive.
    """
    for what, value in (("wrist stiffness", wrist_stiffness), ("wrist and target mass", tip_mass)):
        if not (math.isfinite(value) and value > 0.0):
            raise InputError(f"the {what} must be positive", given=value)
    locked = wrist_stiffness / tip_mass
    square = locked
    for _ in range(200):
        wanted = wrist_stiffness * (1.0 / tip_mass + mobility(math.sqrt(square)).real)
        if abs(wanted - square) <= 1e-12 * square:
            return math.sqrt(wanted), True
        square = max(0.5 * (square + wanted), 1e-3 * square)
    return math.sqrt(locked), False
