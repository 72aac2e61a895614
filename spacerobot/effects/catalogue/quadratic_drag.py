"""Quadratic drag on a floating body."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.catalogue.quadratic_damping import QUADRATIC
from spacerobot.effects.effect import Effect, Parameter, base_ports, positions
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force


class QuadraticDrag(Effect):
    """Air drag at speed: rho C_d A / 2 times the speed squared."""

    name = "quadratic_drag"
    title = "quadratic drag"
    formula = r"f = -c\, |\dot{x}|\, \dot{x}, \quad c = \tfrac12 \rho C_d A"
    source = "Rayleigh (1876)"
    parameters = (Parameter("coefficient_Ns2_m2", "N s^2/m^2", 0.0, 0.5, 0.0, 1e5, (0.01, 0.5, 5.0)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Bodies that float or fall."""
        return positions(mechanism, "target", "target.y", "target.yaw", *base_ports(mechanism))

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A quadratic damper between the body and the world."""
        p = (values["coefficient_Ns2_m2"],)
        return mechanism.with_force(Force(f"{self.name} at {where}", where, QUADRATIC, p))
