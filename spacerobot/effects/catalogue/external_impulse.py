"""An external impulse: a knock at a moment."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import BASE_PORTS, Effect, Parameter, positions
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Impulse


class ExternalImpulse(Effect):
    """A sudden change of a floating body's momentum."""

    name = "external_impulse"
    title = "external impulse"
    phrase = "an external impulse"
    formula = r"m\,\Delta \dot x = J \text{ at } t_J"
    source = "momentum balance"
    parameters = (
        Parameter("impulse_Ns", "N s", 0.0, 0.02, -1e4, 1e4, (0.05, -0.05)),
        Parameter("time_s", "s", 1.0, 0.05, 0.0, 1e5, (0.5, 1.5, 2.5), shape=True, moment=True),
    )

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Bodies that float; one that nothing touches may be struck off its centre too."""
        turning = ("target.yaw",) if mechanism.contact is None else ()
        return positions(mechanism, "target", "target.y", "target.z", *turning, *BASE_PORTS)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A kick at the port."""
        return mechanism.with_impulse(Impulse(where, values["impulse_Ns"], values["time_s"], self.name))
