"""Magnus force: a spinning body that moves is pushed sideways."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force


def force(d: float, v: float, aux: float, p: Any) -> float:
    """coefficient * spin * speed; p = (signed coefficient,)."""
    return p[0] * aux * v


KERNEL = Kernel(force)


class Magnus(Effect):
    """A force across the velocity, in proportion to the spin."""

    name = "magnus"
    title = "Magnus force"
    phrase = "a Magnus force"
    formula = r"\mathbf f = c\, \boldsymbol\omega \times \mathbf v"
    source = "Magnus (1852); Rubinow and Keller (1961)"
    parameters = (Parameter("coefficient_kg", "kg", 0.0, 0.05, -1e3, 1e3, (0.1, -0.1)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """A target that moves in the plane and turns."""
        return ("target",) if {"target.y", "target.yaw"} <= set(mechanism.coordinates) else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """Two forces that together do no work."""
        c = values["coefficient_kg"]
        return mechanism.with_force(
            Force("magnus along", "target", KERNEL, (-c,), sense="target.y", aux="target.yaw"),
            Force("magnus across", "target.y", KERNEL, (c,), sense="target", aux="target.yaw"),
        )
