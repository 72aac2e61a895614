"""Adhesion: the surfaces hold each other up to a tension."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism


class Adhesion(Effect):
    """A tip that sticks: contact ends when the tension reaches a holding force."""

    name = "adhesion"
    title = "adhesion"
    formula = r"F \ge -F_a \text{ while in contact}"
    source = "pull-off force; Johnson, Kendall, Roberts (1971)"
    kind = "contact"
    parameters = (Parameter("force_N", "N", 0.0, 0.2, 0.0, 1e4, (0.3, 2.0, 8.0)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The contact."""
        return ("contact",) if mechanism.contact is not None and not mechanism.contact.bilateral else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The contact's holding force."""
        return mechanism.with_contact(lambda c: replace(c, hold=c.hold + values["force_N"]))
