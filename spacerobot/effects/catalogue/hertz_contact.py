"""Hertzian contact: a power law in the penetration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism


class HertzContact(Effect):
    """Contact force with a power of the penetration; its stiffness is that of the linear law at 1 mm."""

    name = "hertz_contact"
    title = "Hertzian contact"
    formula = r"F = k\, d_\mathrm{ref}\, (d/d_\mathrm{ref})^n, \quad d_\mathrm{ref} = 1\,\mathrm{mm}"
    source = "Hertz (1882); n = 3/2 for elastic spheres"
    kind = "contact"
    parameters = (Parameter("exponent", "1", 1.0, 0.1, 0.5, 4.0, (1.5, 1.2, 0.8)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The contact, where it has the spring-dashpot law."""
        return ("contact",) if mechanism.contact is not None and len(mechanism.contact.p) == 4 else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The contact law's exponent."""
        n = values["exponent"]
        return mechanism.with_contact(lambda c: replace(c, p=(c.p[0], c.p[1], n, c.p[3])))
