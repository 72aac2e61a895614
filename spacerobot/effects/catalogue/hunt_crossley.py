"""Hunt-Crossley contact: damping in proportion to the elastic force."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism


class HuntCrossley(Effect):
    """Contact whose damping grows with the penetration, so that the force starts and ends at zero."""

    name = "hunt_crossley"
    title = "Hunt-Crossley contact"
    formula = r"F = k\, d_\mathrm{ref} (d/d_\mathrm{ref})^n\, (1 + (\chi/k)\,\dot d)"
    source = "Hunt and Crossley (1975), Eq. 6"
    kind = "contact"
    parameters = (
        Parameter("exponent", "1", 1.0, 0.1, 0.5, 4.0, (1.5, 1.0)),
        Parameter("chi_over_k_s_m", "s/m", 0.0, 0.2, 0.0, 100.0, (0.5, 2.0)),
    )
    removes = ("contact.damping",)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The contact, where it has the spring-dashpot law."""
        return ("contact",) if mechanism.contact is not None and len(mechanism.contact.p) == 4 else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The contact law's exponent and its damping ratio, which takes the dashpot's place."""
        n, chi = values["exponent"], values["chi_over_k_s_m"]
        return mechanism.with_contact(lambda c: replace(c, p=(c.p[0], 0.0, n, chi)))
