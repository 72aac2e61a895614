"""Umbilical: hoses and cables that hang from somewhere and pull a floating base towards it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import across
from spacerobot.effects.primitives import Force


def force(d: float, v: float, aux: float, p: Any) -> float:
    """p = (stiffness, force where the displacement is zero)."""
    return p[1] - p[0] * d


def energy(d: float, v: float, aux: float, p: Any) -> float:
    """k d^2 / 2 - F_0 d."""
    return 0.5 * p[0] * d * d - p[1] * d


KERNEL = Kernel(force, energy=energy)


class Umbilical(Effect):
    """A spring in the plane from a base to a fixed point, which is F_0 / k from the origin of the recording.

    Only of a base with an arm: it pulls at the base, where a bowl pulls at the centre of mass. Of a body alone a bowl
    and a tilt are the same law.
    """

    name = "umbilical"
    title = "umbilical"
    phrase = "an umbilical"
    formula = r"\mathbf f = \mathbf F_0 - k_u\, \mathbf x"
    source = "linear spring to a fixed point"
    parameters = (
        Parameter("stiffness_N_m", "N/m", 0.0, 0.5, 0.0, 1e5, (0.3, 2.0, 10.0)),
        Parameter("ahead_N", "N", 0.0, 0.5, -1e4, 1e4, (0.0, 0.5, -0.5)),
        Parameter("aside_N", "N", 0.0, 0.5, -1e4, 1e4, (0.0, 0.5, -0.5)),
    )
    carried = True

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """A base that floats in the plane."""
        return ("base",) if across(mechanism, "base") else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A spring along each axis, of one stiffness."""
        pulls = (values["ahead_N"], values["aside_N"])
        return mechanism.with_force(
            *(
                Force(f"{self.name} at {port}", port, KERNEL, (values["stiffness_N_m"], pull))
                for port, pull in zip((where, *across(mechanism, where)), pulls, strict=True)
            )
        )
