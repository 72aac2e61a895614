"""A payload: mass that the model does not know of."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism


class Payload(Effect):
    """Further mass fixed to a body."""

    name = "payload"
    title = "payload"
    formula = r"m \to m + \Delta m"
    source = "composite rigid body"
    kind = "body"
    parameters = (Parameter("mass_kg", "kg", 0.0, 0.1, -1e3, 1e4, (0.1, 1.0, -0.1)),)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Bodies, and what joints carry."""
        names = ("wrist", "target", "base")
        joints = tuple(n for n in mechanism.coordinates if n.startswith("joint."))
        return tuple(n for n in names if n in mechanism.coordinates) + joints

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The body's mass, with this added, along and sideways."""
        for name in (where, f"{where}.y"):
            if name in mechanism.coordinates:
                total = mechanism.coordinates[name].mass + values["mass_kg"]
                mechanism = mechanism.with_mass(name, max(total, 1e-6))
        return mechanism
