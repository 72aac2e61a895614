"""A table that is not flat."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.catalogue.table_tilt import STANDARD_GRAVITY
from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.laws import SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force


class TableCurvature(Effect):
    """A plate that sags between its supports: its slope grows along the coordinate; positive is a bowl."""

    name = "table_curvature"
    title = "table curvature"
    formula = r"\ddot x = -g\, \kappa\, x, \quad g = 9.80665\,\mathrm{m/s^2}"
    source = "sliding body on z = kappa x^2 / 2, small slopes"
    kind = "gravity"
    parameters = (Parameter("curvature_rad_m", "rad/m", 0.0, 1e-4, -1.0, 1.0, (1e-3, -1e-3, 1e-2)),)
    carried = True

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Bodies that glide over a table for long; a short approach to a wrist tells nothing of it."""
        return positions(mechanism, "target", "target.y", "base", "base.y") if mechanism.contact is None else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The body's weight down the slope where it is."""
        stiffness = mechanism.coordinates[where].mass * STANDARD_GRAVITY * values["curvature_rad_m"]
        return mechanism.with_force(Force(f"{self.name} at {where}", where, SPRING, (stiffness,)))
