"""Gravity that is not as stated: a base that leans, an arm on a wall, torques that are logged without their weight."""

from __future__ import annotations

from collections.abc import Mapping

from spacerobot.effects.effect import Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.settled import Shaped


class OtherGravity(Shaped):
    """A further pull on all that has mass, along a direction of the base's axes.

    A base that leans by a small angle is pulled sideways by that share of gravity; one that feels none at all, upwards
    by the whole of it.
    """

    name = "other_gravity"
    title = "other gravity"
    phrase = "a further pull of gravity"
    formula = r"\vec g \to \vec g + a\, (x, y, z)"
    source = "inclined plane, Galilei (1638)"
    kind = "gravity"
    together = "field"
    parameters = (
        Parameter("pull_m_s2", "m/s^2", 0.0, 0.1, -100.0, 100.0, (0.3, -0.3)),
        *(Parameter(axis, "1", 0.0, 1.0, -1.0, 1.0, (start,), shape=True) for axis, start in zip("xyz", (1.0, 0, 0))),
    )

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The base of what is known to stand in gravity, or in none."""
        return ("base",) if mechanism.gravity is not None else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The pull beside gravity."""
        pull = values["pull_m_s2"]
        return mechanism.with_pull((pull * values["x"], pull * values["y"], pull * values["z"]))
