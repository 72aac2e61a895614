"""Backlash: a gap in which the spring carries nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force


def force(d: float, v: float, aux: float, p: Any) -> float:
    """p = (stiffness, half gap)."""
    if d > p[1]:
        return -p[0] * (d - p[1])
    if d < -p[1]:
        return -p[0] * (d + p[1])
    return 0.0


def edge(d: float, v: float, aux: float, p: Any) -> float:
    """Changes sign at either end of the gap."""
    return abs(d) - p[1]


def energy(d: float, v: float, aux: float, p: Any) -> float:
    """Energy of the deflection beyond the gap."""
    over = max(0.0, abs(d) - p[1])
    return 0.5 * p[0] * over * over


def slope(d: float, v: float, aux: float, p: Any) -> float:
    """None within the gap."""
    return p[0] if aux > 0.0 else 0.0


KERNEL = Kernel(force, edge, energy, slope)


class Backlash(Effect):
    """Free play around the spring's rest position."""

    name = "backlash"
    title = "backlash"
    formula = r"f = -k\,(|d| - g)\operatorname{sign}(d) \text{ for } |d| > g, \text{ else } 0"
    source = "Nordin and Gutman (2002)"
    parameters = (Parameter("half_gap_m", "m", 0.0, 1e-4, 0.0, 0.1, (1e-4, 5e-4, 2e-3)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Wherever a linear spring is."""
        return tuple(f.port for f in mechanism.forces if f.role == "spring")

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The spring replaced by one with a gap."""
        gap = values["half_gap_m"]

        def loosen(spring: Force) -> Force:
            return replace(spring, kernel=KERNEL, p=(spring.p[0], gap))

        return mechanism.with_forces_changed("spring", where, loosen)
