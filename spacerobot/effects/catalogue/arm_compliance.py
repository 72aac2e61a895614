"""A compliant arm: the hand gives way on a spring of its own."""

from __future__ import annotations

import math
from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Force


class ArmCompliance(Effect):
    """The hand as a mass on a spring and damper, where the model holds it still."""

    name = "arm_compliance"
    title = "arm compliance"
    formula = r"m_h \ddot x_h = -k_h x_h - c_h \dot x_h + f_w"
    source = "first bending mode of the arm; assumption of a rigid arm in Uyama et al. (2012)"
    kind = "body"
    stands_for = "an arm of several modes"
    parameters = (
        Parameter("mass_kg", "kg", 20.0, 2.0, 0.05, 1e4, (20.0, 8.0, 60.0), log=True, shape=True),
        Parameter("stiffness_N_m", "N/m", math.inf, 4e3, 10.0, math.inf, (4e4, 2e5, 1e4), log=True),
        Parameter("damping_Ns_m", "N s/m", 0.0, 30.0, 0.0, 1e5, (100.0, 20.0, 400.0), shape=True),
    )

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The arm, where the hand is held."""
        return ("arm",) if "wrist" in mechanism.ports and "hand" not in mechanism.coordinates else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A hand between the world and the wrist's guide; infinite stiffness holds it as before."""
        if math.isinf(values["stiffness_N_m"]):
            return mechanism
        hand = Coordinate("hand", values["mass_kg"])
        flexible = mechanism.with_appendage(
            hand,
            "arm",
            {"hand": 1.0},
            Force("arm.spring", "arm", SPRING, (values["stiffness_N_m"],), role="spring"),
            Force("arm.damper", "arm", DAMPER, (values["damping_Ns_m"],), role="damper"),
        )
        return flexible.with_port_row("wrist", "hand", -1.0).with_port_row("hand", "hand", 1.0)
