"""Asymmetric friction: one Coulomb level each way."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Friction


def level(v: float, normal: float, aux: float, p: Any) -> float:
    """p = (force while moving forwards, force while moving back)."""
    return p[0] if v > 0.0 else p[1]


class AsymmetricFriction(Effect):
    """Dry friction with a level for each direction."""

    name = "asymmetric_friction"
    title = "asymmetric Coulomb friction"
    formula = r"f = -F_+ \; (v > 0), \quad f = +F_- \; (v < 0)"
    source = "Janot, Gautier, Brunot (2019), EMPS benchmark"
    parameters = (
        Parameter("force_plus_N", "N", 0.0, 0.1, 0.0, 1e4, (0.02, 0.2, 1.0)),
        Parameter("force_minus_N", "N", 0.0, 0.1, 0.0, 1e4, (0.02, 0.2, 1.0)),
    )
    refines = ("coulomb_friction",)
    replaces = ("{where}.equivalent_damping",)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides and joints."""
        return positions(mechanism, "wrist", "joint")

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """Friction whose level depends on the direction."""
        p = (values["force_plus_N"], values["force_minus_N"])
        return mechanism.with_friction(Friction(f"{self.name} at {where}", where, level, p, steady=True))
