"""Lift: the sideways push on a body whose steady spin nobody logged."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import PLACES, SPINS, in_space, turned_by
from spacerobot.effects.primitives import Force


def force(d: float, v: float, aux: float, p: Any) -> float:
    """p = (signed coefficient,): the force by another direction's speed."""
    return p[0] * v


KERNEL = Kernel(force)


class Lift(Effect):
    """A Magnus force of a spin about a body's axis ("target" ahead, "target.y" across), the same in every flight.

    Of a spin that is logged it is `magnus`; a spin of its own in each flight is none of these.
    """

    name = "lift"
    title = "lift of a spin that nobody logged"
    phrase = "the lift of a spin that nobody logged"
    formula = r"\mathbf f = \Omega\, \mathbf e \times \mathbf v"
    source = "Rubinow and Keller (1961), the spin taken as constant"
    parameters = (Parameter("coefficient_Ns_m", "N s/m", 0.0, 0.01, -1e4, 1e4, (0.01, -0.01)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The axes of a body in flight whose spin is not told."""
        return PLACES if in_space(mechanism) and not set(SPINS) & mechanism.coordinates.keys() else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """Two forces that together do no work."""
        c = values["coefficient_Ns_m"]
        return mechanism.with_force(
            *(
                Force(f"{self.name} at {port} about {where}", port, KERNEL, (sign * c,), sense=sense)
                for port, sense, sign in turned_by(PLACES.index(where))
            )
        )
