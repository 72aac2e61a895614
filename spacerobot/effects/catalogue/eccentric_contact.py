"""Eccentric contact: the tip meets the target off the line through its centre of mass."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism


class EccentricContact(Effect):
    """A sideways offset of the contact point, so that the hit turns the target."""

    name = "eccentric_contact"
    title = "eccentric contact"
    formula = r"b \to b + e, \quad I \ddot\psi = F\,(a \sin\psi + b \cos\psi)"
    source = "planar impact off the centre of mass, Routh (1905)"
    kind = "contact"
    parameters = (Parameter("offset_m", "m", 0.0, 2e-3, -2.0, 2.0, (0.005, -0.005, 0.02)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The target, where it can turn."""
        return ("target",) if mechanism.contact is not None and "target.yaw" in mechanism.coordinates else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The contact point moved sideways."""
        return mechanism.with_contact(lambda c: replace(c, lateral=c.lateral + values["offset_m"]))
