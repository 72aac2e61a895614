"""LuGre friction: bristles that give, slide at a level that falls with speed, and damp what they do."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from spacerobot.effects.catalogue.stribeck_friction import not_falling
from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.memory import Memory, gives_too_little
from spacerobot.effects.primitives import State
from spacerobot.effects.sizes import Sizes

LEAST = 1e-9
"""Share of the typical force that the level does not fall below, so that no friction is a bristle without force."""


def rate(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """z is the bristles' deflection, p = (Coulomb force, static force, velocity, stiffness, damping)."""
    ratio = v / p[2]
    level = p[0] + (p[1] - p[0]) * math.exp(-ratio * ratio)
    return v - p[3] * way * v * z / level


def force(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """-(s0 z + s1 z')."""
    return -p[3] * z - p[4] * rate


def energy(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """s0 z^2 / 2."""
    return 0.5 * p[3] * z * z


LAW = Memory(rate, force, energy)


class LugreFriction(Effect):
    """Dry friction with bristles."""

    name = "lugre_friction"
    title = "LuGre friction"
    formula = (
        r"f = -\sigma_0 z - \sigma_1 \dot z, \quad \dot z = v - \frac{\sigma_0 |v|}{g(v)} z, \quad "
        r"g = F_c + (F_s - F_c)\, e^{-(v/v_s)^2}"
    )
    source = "Canudas de Wit, Olsson, Astrom, Lischinsky (1995), IEEE Trans. Autom. Control 40, 419-425, Eqs. 1 to 4"
    parameters = (
        Parameter("coulomb_force_N", "N", 0.0, 0.1, 0.0, 1e4, (0.05, 0.3, 1.0)),
        Parameter("static_force_N", "N", 0.0, 0.1, 0.0, 1e4, (0.1, 0.5, 2.0)),
        Parameter("velocity_m_s", "m/s", 0.01, 0.01, 1e-5, 10.0, (0.01, 0.03), log=True, shape=True),
        Parameter("bristle_stiffness_N_m", "N/m", 1e4, 1e3, 1.0, 1e9, (3e4, 1e3), log=True, shape=True),
        Parameter("bristle_damping_Ns_m", "N s/m", 1.0, 1.0, 1e-6, 1e6, (3.0,), log=True, shape=True),
    )
    refines = ("stribeck_friction",)
    limits: ClassVar[Mapping[str, float]] = {"bristle_stiffness_N_m": 1e8, "bristle_damping_Ns_m": 1e3}
    replaces = ("{where}.equivalent_damping",)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides and joints."""
        return positions(mechanism, "wrist", "joint")

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """Friction falls with speed, within the speeds that were seen; the bristles give by a length that shows."""
        length = values["coulomb_force_N"] / values["bristle_stiffness_N_m"]
        return gives_too_little(length, sizes) or not_falling(values, sizes)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """Bristles beside what acts at the port; none where they can hold nothing."""
        coulomb, static = values["coulomb_force_N"], values["static_force_N"]
        if coulomb <= 0.0 and static <= 0.0:
            return mechanism
        bristles = (values["bristle_stiffness_N_m"], values["bristle_damping_Ns_m"])
        least = LEAST * max(coulomb, static)
        p = (max(coulomb, least), max(static, least), values["velocity_m_s"], *bristles)
        size = max(coulomb, static) / bristles[0]
        return mechanism.with_state(State(f"{self.name} at {where}", where, LAW, p, size))
