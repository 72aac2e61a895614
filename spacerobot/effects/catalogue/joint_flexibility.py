"""Joint flexibility: what a joint moves is not rigid behind its motor, a part of its inertia rides on a spring."""

from __future__ import annotations

import math
from collections.abc import Mapping

from spacerobot.effects.divided import divided
from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.sizes import Sizes
from spacerobot.support.errors import InputError


class JointFlexibility(Effect):
    """The joint's inertia divided in two: the motor's, whose angle is read, and the link's behind a spring."""

    name = "joint_flexibility"
    title = "joint flexibility"
    formula = r"J_l \ddot q_l = -k (q_l - q) - c (\dot q_l - \dot q), \quad J \to J - J_l"
    source = "Spong (1987), J. Dyn. Sys. Meas. Control 109, 310; first mode of a flexible link"
    kind = "body"
    parameters = (
        Parameter("link_inertia_kg_m2", "kg", 0.0, 0.1, 0.0, 1e6, (0.3, 0.1, 0.6)),
        Parameter("stiffness_N_m", "N/m", 100.0, 10.0, 1e-6, 1e12, (100.0, 10.0, 1000.0), log=True, shape=True),
        Parameter("damping_Ns_m", "N s/m", 0.1, 0.1, 0.0, 1e9, (0.1, 1.0), shape=True),
    )

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Joints whose motion is shown, so that what hides behind them can move by itself.

        Not those of a whole arm with its wrist: its links weigh what they weigh wherever they point, and no share of a
        joint's inertia can be taken from them.
        """
        if "wrist" in mechanism.coordinates:
            return ()
        shown = {r.of for r in mechanism.readouts.values()}
        return tuple(n for n in mechanism.coordinates if n.startswith("joint.") and n in shown)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The link's share of the inertia on a spring of its own; what drives the joint drives the motor.

        Raises:
            InputError: more inertia than the joint has.
        """
        share = values["link_inertia_kg_m2"]
        if share == 0.0:
            return mechanism
        own = mechanism.coordinates[where]
        if share >= own.mass:
            raise InputError(
                "link_inertia_kg_m2 is all of the joint's inertia or more, and it is a part of it",
                given=share,
                valid=f"below {own.mass:g}",
                where=f"{self.name} at {where}",
            )
        edited, _ = divided(
            mechanism, where, "link", share, stiffness=values["stiffness_N_m"], damping=values["damping_Ns_m"]
        )
        return edited

    def swinging(self, inertia: float, pace: float, ratio: float) -> Mapping[str, float]:
        """The link's inertia on its spring and damper."""
        return {
            "link_inertia_kg_m2": inertia,
            "stiffness_N_m": inertia * pace**2,
            "damping_Ns_m": 2.0 * ratio * inertia * pace,
        }

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """Past critical damping nothing swings: such a link only lags, as a filter of the motion's noise does."""
        critical = 2.0 * math.sqrt(values["stiffness_N_m"] * values["link_inertia_kg_m2"])
        return "" if values["damping_Ns_m"] <= critical else "a link that is damped past swinging only lags"
