"""Viscous friction in a guide or joint."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.laws import DAMPER
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force


class ViscousFriction(Effect):
    """Damping proportional to speed between two parts."""

    name = "viscous_friction"
    title = "viscous friction"
    curve = "a line in v"
    formula = r"f = -c\, v"
    source = "Newton (1687)"
    parameters = (Parameter("coefficient_Ns_m", "N s/m", 0.0, 1.0, 0.0, 1e5, (0.3, 3.0, 30.0)),)
    replaces = ("{where}.equivalent_damping",)
    same_as = ("equivalent_damping", "damping")

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides and joints."""
        return positions(mechanism, "wrist", "joint")

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A further damper at the port."""
        return mechanism.with_force(Force(f"{self.name} at {where}", where, DAMPER, (values["coefficient_Ns_m"],)))
