"""Viscous drag on a floating body."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter, base_ports, positions
from spacerobot.effects.laws import DAMPER
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force


class ViscousDrag(Effect):
    """Drag proportional to the body's own speed: an air film, slow air."""

    name = "viscous_drag"
    title = "viscous drag"
    formula = r"f = -c\, \dot{x}"
    source = "Stokes (1851)"
    parameters = (Parameter("coefficient_Ns_m", "N s/m", 0.0, 0.1, 0.0, 1e4, (0.03, 0.3, 3.0)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Bodies that float."""
        return positions(mechanism, "target", "target.y", "target.yaw", *base_ports(mechanism))

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A damper between the body and the world."""
        return mechanism.with_force(Force(f"{self.name} at {where}", where, DAMPER, (values["coefficient_Ns_m"],)))
