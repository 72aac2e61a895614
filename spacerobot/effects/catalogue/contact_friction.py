"""Friction between the tip and the target's surface."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Friction


def level(v: float, normal: float, aux: float, p: Any) -> float:
    """mu N; p = (mu,)."""
    return p[0] * normal


class ContactFriction(Effect):
    """Coulomb friction across the contact, in proportion to its normal force."""

    name = "contact_friction"
    title = "contact friction"
    formula = r"|f_t| \le \mu F_n"
    source = "Coulomb (1785)"
    kind = "contact"
    parameters = (Parameter("mu", "1", 0.0, 0.05, 0.0, 5.0, (0.05, 0.2, 0.6)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The contact, where the target can turn or move sideways."""
        moving = "target.yaw" in mechanism.coordinates or "target.y" in mechanism.coordinates
        return ("contact",) if mechanism.contact is not None and moving else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """Friction in the tangential port, pressed by the contact."""
        friction = Friction(self.name, "contact.slide", level, (values["mu"],), normal="contact")
        return mechanism.with_sideways().with_friction(friction)
