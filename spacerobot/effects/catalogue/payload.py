"""A payload: mass that the model does not know of."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.sizes import Sizes
from spacerobot.support.errors import InputError


class Payload(Effect):
    """Further mass fixed to a body."""

    name = "payload"
    title = "payload"
    phrase = "a payload"
    formula = r"m \to m + \Delta m"
    source = "composite rigid body"
    kind = "body"
    parameters = (Parameter("mass_kg", "kg", 0.0, 0.1, -1e3, 1e4, (0.1, 1.0, -0.1)),)
    same_as = ("mass",)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Bodies, and what joints carry."""
        names = ("wrist", "target", "base")
        joints = tuple(n for n in mechanism.coordinates if n.startswith("joint."))
        return tuple(n for n in names if n in mechanism.coordinates) + joints

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """Mass that is there; less of it than believed is a wrong value, not a payload."""
        return "" if values["mass_kg"] > 0.0 else "less mass than believed is a wrong value, no payload"

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The body's mass, with this added, along and sideways.

        Raises:
            InputError: it takes away all that the body has, or more.
        """
        for name in (where, f"{where}.y"):
            if name in mechanism.coordinates:
                own = mechanism.coordinates[name].mass
                if own + values["mass_kg"] <= 0.0:
                    unit = "kg m^2" if mechanism.coordinates[name].angular else "kg"
                    raise InputError(
                        "mass_kg takes away all that is there or more",
                        given=values["mass_kg"],
                        valid=f"above {-own:g} {unit}",
                        where=f"{self.name} at {where}",
                    )
                mechanism = mechanism.with_mass(name, own + values["mass_kg"])
        return mechanism
