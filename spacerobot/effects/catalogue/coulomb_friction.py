"""Coulomb friction: a constant force against the sliding, and sticking below it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Friction


def level(v: float, normal: float, aux: float, p: Any) -> float:
    """p = (force,)."""
    return p[0]


class CoulombFriction(Effect):
    """Dry friction of one level."""

    name = "coulomb_friction"
    title = "Coulomb friction"
    curve = "a level of friction"
    formula = r"f = -F_c \operatorname{sign}(v), \quad |f| \le F_c \text{ at rest}"
    source = "Coulomb (1785)"
    parameters = (Parameter("force_N", "N", 0.0, 0.1, 0.0, 1e4, (0.02, 0.2, 1.0)),)
    replaces = ("{where}.equivalent_damping",)
    carried = True

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides, joints, and a body that slides on a table."""
        bearing = ("target.yaw",) if mechanism.contact is None else ()
        return positions(mechanism, "wrist", "target", "target.y", *bearing, "base", "joint")

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """Friction of constant level at the port."""
        p = (values["force_N"],)
        return mechanism.with_friction(Friction(f"{self.name} at {where}", where, level, p, steady=True))
