"""Whether a run leaves the range in which a learned law was learned: beyond it nothing is known."""

from __future__ import annotations

import numpy as np

from spacerobot.effects.formula import OF_UNIT, FormulaLaw
from spacerobot.effects.learned import Law, Nameless
from spacerobot.effects.registry import effect
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.trajectory import Trajectory

_SHOWN = {
    ("wrist", "d"): "wrist.deflection",
    ("wrist", "v"): "wrist.deflection.velocity",
    ("target", "d"): "target.x",
    ("target", "v"): "target.x.velocity",
    ("contact", "d"): "contact.penetration",
    ("contact", "v"): "contact.penetration.velocity",
}
"""Channels that show what laws at these ports depend on."""


class ExtrapolationWarning(UserWarning):
    """A learned law is asked for more than recordings have shown of it."""


def extrapolated(scene: Scene, trajectory: Trajectory) -> tuple[str, ...]:
    """A sentence for each learned law that the run asks for more than recordings have shown."""
    said = []
    for placed in scene.effects:
        law = effect(placed.effect)
        if not isinstance(law, Nameless):
            continue
        shape: Law = law.shape
        channel = "contact.force" if shape.of == "N" else _SHOWN.get((placed.where, shape.of), "")
        seen = trajectory.channels.get(channel)
        if seen is None:
            continue
        if placed.where == "contact":
            seen = seen[trajectory.channels["contact.penetration"] > 0.0]
        low, high = (float(np.min(seen)), float(np.max(seen))) if seen.size else (shape.low, shape.high)
        if low < shape.low or high > shape.high:
            goes_on = (
                "its formula is taken at its word there" if isinstance(law, FormulaLaw) else "its end value is held"
            )
            said.append(
                f"the law learned at the {placed.where} is known from {shape.low:.4g} to {shape.high:.4g} "
                f"{OF_UNIT[shape.of]}; this run goes from {low:.4g} to {high:.4g}: {goes_on}"
            )
    return tuple(said)
