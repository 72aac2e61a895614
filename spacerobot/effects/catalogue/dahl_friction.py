"""Dahl's friction: a bristle that gives before it slides, with no level of its own at rest."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.memory import Memory, gives_too_little
from spacerobot.effects.primitives import State
from spacerobot.effects.sizes import Sizes

LEAST = 1e-9
"""Deflection [m or rad] below which a bristle's give is nothing that anybody could see."""


def rate(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """z is the share of the full force, p = (force, deflection at it)."""
    return v / p[1] * (1.0 - way * z)


def force(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """-F z."""
    return -p[0] * z


def energy(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """F x0 (|z| - ln(1 + |z|)): what comes back until the force is nothing, where the motion turns."""
    return p[0] * p[1] * (abs(z) - math.log1p(abs(z)))


LAW = Memory(rate, force, energy)


class DahlFriction(Effect):
    """Dry friction with a spring in it."""

    name = "dahl_friction"
    title = "Dahl friction"
    formula = r"\dot f = -\sigma\, v \left(1 + \frac{f}{F_c} \operatorname{sign}(v)\right)"
    source = "Dahl (1968), Aerospace Report TOR-158(3107-18); Dahl (1976), AIAA J. 14, 1675-1682, i = 1"
    parameters = (
        Parameter("force_N", "N", 0.0, 0.1, 0.0, 1e4, (0.1, 0.4, 1.5)),
        Parameter("stiffness_N_m", "N/m", 1e4, 1e3, 1.0, 1e9, (3e4, 3e3, 3e2), log=True, shape=True),
    )
    refines = ("coulomb_friction",)
    limits: ClassVar[Mapping[str, float]] = {"stiffness_N_m": 1e8}
    replaces = ("{where}.equivalent_damping",)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides and joints."""
        return positions(mechanism, "wrist", "joint")

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """The bristle gives by a length that shows."""
        return gives_too_little(values["force_N"] / values["stiffness_N_m"], sizes)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A bristle beside what acts at the port; none where it can hold nothing."""
        level = values["force_N"]
        if level <= 0.0:
            return mechanism
        p = (level, max(level / values["stiffness_N_m"], LEAST))
        return mechanism.with_state(State(f"{self.name} at {where}", where, LAW, p, 1.0))
