"""Table tilt: a floating body is pulled along by gravity."""

from __future__ import annotations

import math
from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Field

STANDARD_GRAVITY = 9.80665


class TableTilt(Effect):
    """A table that is not level; the angle is counted along the coordinate, whatever the scene's own gravity."""

    name = "table_tilt"
    title = "table tilt"
    formula = r"\ddot x = g \sin\alpha, \quad g = 9.80665\,\mathrm{m/s^2}"
    source = "inclined plane, Galilei (1638)"
    kind = "gravity"
    parameters = (Parameter("angle_rad", "rad", 0.0, 5e-5, -0.5, 0.5, (1e-4, -1e-4, 1e-3)),)
    carried = True

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Bodies that float on a table."""
        floating = ("base", "base.y") if mechanism.contact is None else ()
        return positions(mechanism, "target", "target.y", *floating)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A uniform acceleration of the body and of all it carries."""
        pull = STANDARD_GRAVITY * math.sin(values["angle_rad"])
        carried = [c.name for c in mechanism.coordinates.values() if c.carrier == where]
        return mechanism.with_field(*(Field(body, pull, self.name) for body in (where, *carried)))
