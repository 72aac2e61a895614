"""Tether: a cable that goes taut."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.catalogue.backlash import KERNEL
from spacerobot.effects.effect import BASE_PORTS, Effect, Parameter, positions
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force


class Tether(Effect):
    """A cable or hose between a floating body and the world, slack near the origin."""

    name = "tether"
    title = "tether"
    phrase = "a tether"
    formula = r"f = -k_t\,(|x| - s)\operatorname{sign}(x) \text{ for } |x| > s"
    source = "linear cable with slack"
    parameters = (
        Parameter("stiffness_N_m", "N/m", 0.0, 0.5, 0.0, 1e5, (0.3, 2.0, 10.0)),
        Parameter("slack_m", "m", 0.0, 0.01, 0.0, 10.0, (0.0, 0.02, 0.05), shape=True),
    )
    carried = True

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Bodies that float."""
        return positions(mechanism, "target", "target.y", *BASE_PORTS[:3])

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A spring that acts beyond the slack."""
        p = (values["stiffness_N_m"], values["slack_m"])
        return mechanism.with_force(Force(f"{self.name} at {where}", where, KERNEL, p))
