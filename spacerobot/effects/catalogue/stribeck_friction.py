"""Stribeck friction: higher at rest than in motion, falling with speed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from spacerobot.effects.creeping import KIND, Creeping, along
from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Friction
from spacerobot.effects.sizes import Sizes


def level(v: float, normal: float, aux: float, p: Any) -> float:
    """p = (static, coulomb, velocity)."""
    ratio = v / p[2]
    return p[1] + (p[0] - p[1]) * math.exp(-ratio * ratio)


def smooth(d: float, v: float, aux: float, p: Any) -> float:
    """p = (static, coulomb, velocity, speed below which it creeps)."""
    return -level(v, 0.0, aux, p) * along(v, aux, p[3])


SMOOTH = Kernel(smooth)

LEVEL = r"F_c + (F_s - F_c)\, e^{-(v/v_s)^2}"

SLOW = 0.5**0.5
"""Stribeck's velocity lies below this share of the typical speed, at which a seventh of the fall is left then: exp(-2).
A law that falls wherever it was seen is a damper in disguise.
"""


def not_falling(values: Mapping[str, float], sizes: Sizes) -> str:
    """Why a friction does not fall with speed within the speeds that were seen, one clause; empty where it does."""
    if values["static_force_N"] <= values["coulomb_force_N"]:
        return "its friction does not fall with speed"
    speed = sizes.length / sizes.time
    if values["velocity_m_s"] >= SLOW * speed:
        return f"at {values['velocity_m_s'] / speed:.2g} times the typical speed it still falls: a damper in disguise"
    return ""


class StribeckFriction(Effect):
    """Dry friction that falls from a static to a sliding level."""

    name = "stribeck_friction"
    title = "Stribeck friction"
    formula = r"|f| \le " + LEVEL
    source = "Stribeck (1902); Armstrong-Helouvry, Dupont, Canudas de Wit (1994), Eq. 4"
    parameters = (
        Parameter("static_force_N", "N", 0.0, 0.1, 0.0, 1e4, (0.1, 0.5, 2.0)),
        Parameter("coulomb_force_N", "N", 0.0, 0.1, 0.0, 1e4, (0.05, 0.3, 1.0)),
        Parameter("velocity_m_s", "m/s", 0.01, 0.01, 1e-5, 10.0, (0.01, 0.03, 0.1), log=True, shape=True),
    )
    refines = ("coulomb_friction",)
    replaces = ("{where}.equivalent_damping",)
    forms = (KIND,)

    def in_form(self, form: str) -> Effect:
        """Smooth about rest: "creeping"."""
        return Creeping(self, SMOOTH, rf"\left({LEVEL}\right)") if form == KIND else super().in_form(form)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides and joints."""
        return positions(mechanism, "wrist", "joint")

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """Friction falls with speed, within the speeds that were seen."""
        return not_falling(values, sizes)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """Friction whose level falls with speed."""
        p = (values["static_force_N"], values["coulomb_force_N"], values["velocity_m_s"])
        return mechanism.with_friction(Friction(f"{self.name} at {where}", where, level, p))
