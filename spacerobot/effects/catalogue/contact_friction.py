"""Friction between the tip and the target's surface."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
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
    formula = r"|\mathbf f_t| \le \mu F_n"
    source = "Coulomb (1785)"
    kind = "contact"
    parameters = (Parameter("mu", "1", 0.0, 0.05, 0.0, 5.0, (0.05, 0.2, 0.6)),)
    instant = True

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The contact, where the target can turn or move sideways."""
        moving = "target.yaw" in mechanism.coordinates or "target.y" in mechanism.coordinates
        return ("contact",) if mechanism.contact is not None and moving else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """Friction in the tangential port, pressed by the contact; added to what the surfaces have already."""
        there = [f for f in mechanism.frictions if f.port == "contact.slide" and f.level is level]
        mu = values["mu"] + sum(f.p[0] for f in there)
        friction = Friction(self.name, "contact.slide", level, (mu,), normal="contact")
        others = tuple(f for f in mechanism.frictions if f not in there)
        return replace(mechanism.with_sideways(), frictions=(*others, friction))
