"""Preload: a constant force in a guide or joint."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.kernel import Kernel, no_slope
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force


def force(d: float, v: float, aux: float, p: Any) -> float:
    """p = (force,)."""
    return p[0]


def energy(d: float, v: float, aux: float, p: Any) -> float:
    """-F d."""
    return -p[0] * d


KERNEL = Kernel(force, energy=energy, slope=no_slope)


class Preload(Effect):
    """A constant push along the port: a pretensioned spring, an unbalanced weight, an amplifier's offset."""

    name = "preload"
    title = "preload"
    phrase = "a preload"
    curve = "a constant"
    formula = r"f = F_0"
    source = "constant force"
    same_as = ("bias",)
    parameters = (Parameter("force_N", "N", 0.0, 0.1, -1e4, 1e4, (0.1, -0.1, 1.0)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides and joints."""
        return positions(mechanism, "wrist", "joint")

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A constant force at the port."""
        return mechanism.with_force(Force(f"{self.name} at {where}", where, KERNEL, (values["force_N"],)))
