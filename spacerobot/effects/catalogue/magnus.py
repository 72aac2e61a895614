"""Magnus force: a spinning body that moves is pushed sideways."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import SPINS, turned_by
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
        """A target that moves in the plane or in space and turns."""
        return ("target",) if _pushes(mechanism) else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """Forces that together do no work."""
        c = values["coefficient_kg"]
        return mechanism.with_force(
            *(
                Force(f"{self.name} at {port} by {spin}", port, KERNEL, (sign * c,), sense=sense, aux=spin)
                for port, sense, spin, sign in _pushes(mechanism)
            )
        )


def _pushes(mechanism: Mechanism) -> list[tuple[str, str, str, float]]:
    """Of a cross product spin x velocity: port, the velocity's, the spin, and the sign, one after the other."""
    known = mechanism.coordinates
    every = [(port, sense, spin, sign) for k, spin in enumerate(SPINS) for port, sense, sign in turned_by(k)]
    return [push for push in every if {*push[:3]} <= known.keys()]
