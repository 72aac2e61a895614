"""Hysteresis: a force that depends on the path, stiff where the motion turns and level after a while."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.memory import Memory, gives_too_little
from spacerobot.effects.primitives import State
from spacerobot.effects.sizes import Sizes


def rate(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """z is the share of the full force, p = (force, displacement); |z| sign(v z) is z sign(v)."""
    return v / p[1] * (1.0 - 0.5 * (abs(z) + way * z))


def force(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """-F z."""
    return -p[0] * z


def energy(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """F x0 z^2 / 2, what comes back where the motion turns and the force falls along the stiffness F / x0."""
    return 0.5 * p[0] * p[1] * z * z


LAW = Memory(rate, force, energy)


class BoucWen(Effect):
    """Hysteresis of one level."""

    name = "bouc_wen"
    title = "hysteresis"
    formula = r"f = -F z, \quad \dot z = \frac{v}{x_0}\left(1 - \tfrac12 |z| (1 + \operatorname{sign}(v z))\right)"
    source = "Bouc (1967); Wen (1976), J. Eng. Mech. Div. 102, 249-263, Eq. 6 with n = 1, beta = gamma"
    parameters = (
        Parameter("force_N", "N", 0.0, 0.1, 0.0, 1e4, (0.2, 0.8, 3.0)),
        Parameter("displacement_m", "m", 1e-3, 1e-3, 1e-9, 10.0, (3e-4, 1e-3, 4e-3), log=True, shape=True),
    )
    refines = ("coulomb_friction",)
    limits: ClassVar[Mapping[str, float]] = {"displacement_m": 1e-9}
    replaces = ("{where}.equivalent_damping",)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides and joints."""
        return positions(mechanism, "wrist", "joint")

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """The force builds up over a length that shows."""
        return gives_too_little(values["displacement_m"], sizes)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A force beside what acts at the port."""
        p = (values["force_N"], values["displacement_m"])
        return mechanism.with_state(State(f"{self.name} at {where}", where, LAW, p, 1.0))
