"""Quadratic drag on a floating body."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from spacerobot.effects.catalogue.quadratic_damping import QUADRATIC
from spacerobot.effects.effect import BASE_PORTS, Effect, Parameter
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import across, along_all, bodies
from spacerobot.effects.primitives import Force


def beside(d: float, v: float, aux: float, p: Any) -> float:
    """One component of -c |v| v; aux is the speed across, p = (coefficient,)."""
    return -p[0] * math.hypot(v, aux) * v


BESIDE = Kernel(beside)


class QuadraticDrag(Effect):
    """Air drag at speed: rho C_d A / 2 times the speed squared."""

    name = "quadratic_drag"
    title = "quadratic drag"
    formula = r"\mathbf f = -c\, |\mathbf v|\, \mathbf v, \quad c = \tfrac12 \rho C_d A"
    source = "Rayleigh (1876)"
    parameters = (Parameter("coefficient_Ns2_m2", "N s^2/m^2", 0.0, 0.5, 0.0, 1e5, (0.01, 0.5, 5.0)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Bodies that float or fall."""
        return bodies(mechanism, "target", "target.y", "target.yaw", *BASE_PORTS)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A quadratic damper between the body and the world, against the velocity in the plane or in space."""
        p, others = (values["coefficient_Ns2_m2"],), across(mechanism, where)
        if not others:
            return mechanism.with_force(Force(f"{self.name} at {where}", where, QUADRATIC, p))
        return mechanism.with_force(*along_all(self.name, (where, *others), BESIDE, p))
