"""The weight of what a joint carries, as the joint feels it: of one joint alone it is known in closed form."""

from __future__ import annotations

import math
from typing import Any

from spacerobot.effects.kernel import Kernel


def weight_force(d: float, v: float, aux: float, p: Any) -> float:
    """-(a sin q + b cos q) with the joint's angle q = d; p = (a, b)."""
    return -(p[0] * math.sin(d) + p[1] * math.cos(d))


def weight_energy(d: float, v: float, aux: float, p: Any) -> float:
    """Height times weight, counted from where the joint is at right angles to gravity."""
    return -p[0] * math.cos(d) + p[1] * math.sin(d)


WEIGHT = Kernel(weight_force, energy=weight_energy)
"""Of a joint that turns: gravity's torque on whatever rigid thing it carries is a sine of its angle."""
