"""A load on a link: a tool, a gripper, a cable that the model does not know of, or one that is not there."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Load
from spacerobot.effects.settled import Shaped

AXES = ("x_m", "y_m", "z_m")
"""Names of the parameters that say where a load is, in its link's frame."""


class LinkLoad(Shaped):
    """A small heavy body fixed to a link: weight and inertia at every joint that carries it."""

    name = "link_load"
    title = "load"
    phrase = "a load"
    formula = r"\tau \to \tau + J_c^T\, m\, (\ddot c - g)"
    source = "Atkeson, An and Hollerbach (1986), Int. J. Robotics Research 5(3), 101"
    kind = "body"
    together = "point"
    parameters = (
        Parameter("mass_kg", "kg", 0.0, 0.1, -1e3, 1e4, (1.0, 0.1, -0.3)),
        *(Parameter(axis, "m", 0.0, 0.1, -10.0, 10.0, (0.0,), shape=True) for axis in AXES),
    )

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Links that move."""
        return mechanism.links

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The load beside what the link has."""
        x, y, z = (values[axis] for axis in AXES)
        return mechanism.with_load(Load(where, values["mass_kg"], (x, y, z)))
