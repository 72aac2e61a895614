"""A link that is heavier, or lighter, than its model, and as it is distributed in it."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Load


class HeavierLink(Effect):
    """More of what a joint moves by itself: weight and inertia in proportion, at every joint that carries it."""

    name = "heavier_link"
    title = "heavier link"
    phrase = "mass of the link itself"
    formula = r"\phi \to \left(1 + \frac{m}{m_0}\right) \phi, \quad \tau = Y(q, \dot q, \ddot q)\, \phi"
    source = "Atkeson, An and Hollerbach (1986), Int. J. Robotics Research 5(3), 101, eq. 4"
    kind = "body"
    together = "whole"
    parameters = (Parameter("mass_kg", "kg", 0.0, 0.1, -1e3, 1e4, (1.0, 0.1, -0.3)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Links that move."""
        return mechanism.links

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The link, and what is fixed to it, so much heavier."""
        return mechanism.with_load(Load(where, values["mass_kg"], None))
