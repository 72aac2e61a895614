"""Viscous drag on a floating body."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import BASE_PORTS, Effect, Parameter
from spacerobot.effects.laws import DAMPER
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import across, bodies
from spacerobot.effects.primitives import Force


class ViscousDrag(Effect):
    """Drag proportional to the body's own speed: an air film, slow air."""

    name = "viscous_drag"
    title = "viscous drag"
    formula = r"\mathbf f = -c\, \mathbf v"
    source = "Stokes (1851)"
    parameters = (Parameter("coefficient_Ns_m", "N s/m", 0.0, 0.1, 0.0, 1e4, (0.03, 0.3, 3.0)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Bodies that float."""
        return bodies(mechanism, "target", "target.y", "target.yaw", *BASE_PORTS)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A damper between the body and the world, in every direction that it has."""
        p = (values["coefficient_Ns_m"],)
        along = (where, *across(mechanism, where))
        return mechanism.with_force(*(Force(f"{self.name} at {n}", n, DAMPER, p) for n in along))
