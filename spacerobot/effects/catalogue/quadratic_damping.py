"""Quadratic damping in a guide or joint."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force


def force(d: float, v: float, aux: float, p: Any) -> float:
    """p = (coefficient,)."""
    return -p[0] * abs(v) * v


QUADRATIC = Kernel(force)


class QuadraticDamping(Effect):
    """Damping with the square of the speed: oil through an orifice."""

    name = "quadratic_damping"
    title = "quadratic damping"
    curve = "a square in v"
    formula = r"f = -c\, |v|\, v"
    source = "Torricelli's orifice law"
    parameters = (Parameter("coefficient_Ns2_m2", "N s^2/m^2", 0.0, 5.0, 0.0, 1e6, (5.0, 50.0, 300.0)),)
    replaces = ("{where}.equivalent_damping",)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides and joints."""
        return positions(mechanism, "wrist", "joint")

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A quadratic damper at the port."""
        p = (values["coefficient_Ns2_m2"],)
        return mechanism.with_force(Force(f"{self.name} at {where}", where, QUADRATIC, p))
