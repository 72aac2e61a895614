"""Cubic stiffness: a spring that hardens, or softens."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force


def force(d: float, v: float, aux: float, p: Any) -> float:
    """p = (k3,)."""
    return -p[0] * d * d * d


def energy(d: float, v: float, aux: float, p: Any) -> float:
    """k3 d^4 / 4."""
    return 0.25 * p[0] * d * d * d * d


class CubicStiffness(Effect):
    """A spring force with a cubic part."""

    name = "cubic_stiffness"
    title = "cubic stiffness"
    curve = "a cube in d"
    formula = r"f = -k_3\, d^3"
    source = "Duffing (1918)"
    parameters = (Parameter("k3_N_m3", "N/m^3", 0.0, 5e4, -1e9, 1e9, (5e4, -5e4, 5e5)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Wherever a spring is."""
        return tuple(f.port for f in mechanism.forces if f.role == "spring")

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A cubic spring beside the linear one."""
        kernel = Kernel(force, energy=energy)
        return mechanism.with_force(Force(f"{self.name} at {where}", where, kernel, (values["k3_N_m3"],)))
