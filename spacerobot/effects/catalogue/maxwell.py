"""A relaxing spring: a spring and a damper in series, beside the spring that is there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.memory import Memory
from spacerobot.effects.primitives import State

USUAL_STRETCH = 1e-3
"""Stretch [m or rad] of the branch's spring by which errors are measured."""


def rate(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """The branch's spring is stretched by the motion, and relaxes; z is its stretch, p = (stiffness, relaxation)."""
    return v - z / p[1]


def force(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """-k z."""
    return -p[0] * z


def energy(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """k z^2 / 2."""
    return 0.5 * p[0] * z * z


LAW = Memory(rate, force, energy, linear=True)


class Maxwell(Effect):
    """A part of the stiffness that relaxes: rubber, a cable, a glued joint."""

    name = "maxwell"
    title = "relaxing spring"
    formula = r"f = -s, \quad \dot s = k\, v - s / T"
    source = "Maxwell (1867), Phil. Trans. R. Soc. 157, 49-88"
    parameters = (
        Parameter("stiffness_N_m", "N/m", 0.0, 20.0, 0.0, 1e7, (30.0, 200.0, 1000.0)),
        Parameter("relaxation_s", "s", 0.1, 0.1, 1e-4, 1e3, (0.01, 0.1, 1.0), log=True, shape=True),
    )
    replaces = ("{where}.equivalent_damping",)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides and joints."""
        return positions(mechanism, "wrist", "joint")

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A branch beside what acts at the port."""
        p = (values["stiffness_N_m"], values["relaxation_s"])
        return mechanism.with_state(State(f"{self.name} at {where}", where, LAW, p, USUAL_STRETCH))
