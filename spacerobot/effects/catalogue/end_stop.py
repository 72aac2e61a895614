"""End stop: a stiff spring beyond the travel."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from spacerobot.effects.catalogue.backlash import KERNEL
from spacerobot.effects.effect import Effect, Parameter, positions
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.one_sided import SIDES, OneSided
from spacerobot.effects.primitives import Force
from spacerobot.effects.sizes import Sizes

STIFF = 0.3
"""A stop is at least so many times as stiff as a spring that the typical force bends by the typical length: a rubber
buffer is as stiff as the spring beside it, and a spring that merely hardens is far softer."""

OFTEN = 0.05
"""Share of the way on one side of zero from which on a place goes to that side as well."""


class EndStop(Effect):
    """A stop that a guide or joint runs into, either way; the force is that of a spring with a gap."""

    name = "end_stop"
    title = "end stop"
    phrase = "an end stop"
    formula = r"f = -k_s\,(|d| - d_s)\operatorname{sign}(d) \text{ for } |d| > d_s"
    source = "spring beyond a gap; Nordin and Gutman (2002)"
    parameters = (
        Parameter("travel_m", "m", 0.01, 1e-3, 0.0, 10.0, (0.01, 0.02, 0.03), shape=True, reach=True),
        Parameter("stiffness_N_m", "N/m", 0.0, 1e4, 0.0, 1e8, (1e3, 1e4, 1e5)),
    )
    forms = tuple(SIDES)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Guides and joints."""
        return positions(mechanism, "wrist", "joint")

    def in_form(self, form: str) -> Effect:
        """A stop on one side alone, "above" or "below"."""
        return OneSided(self, form) if form in self.forms else super().in_form(form)

    def forms_at(self, seen: np.ndarray) -> tuple[str, ...]:
        """A stop on one side is another than this where the place goes to the other side as well."""
        up, down = float(seen.max(initial=0.0)), -float(seen.min(initial=0.0))
        most = max(up, down)
        return tuple(s for s, beyond in zip(SIDES, (down, up), strict=True) if beyond > OFTEN * most)

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """No softer than a buffer, beside the springs that work there."""
        times = values["stiffness_N_m"] * sizes.length / sizes.force
        return "" if times > STIFF else f"with {times:.2g} times the stiffness of what works there it stops nothing"

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A spring that acts beyond the travel."""
        p = (values["stiffness_N_m"], values["travel_m"])
        return mechanism.with_force(Force(f"{self.name} at {where}", where, KERNEL, p))
