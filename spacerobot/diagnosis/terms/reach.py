"""Where an effect may begin that acts beyond a displacement: just short of where its place came furthest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spacerobot.effects.effect import Effect

JUST_BELOW = 0.99
"""Share of the largest displacement recorded at which a stop is looked for: it gives way, and there is noise."""


SHARES = (JUST_BELOW, 0.95, 0.9, 0.8, 0.6)
"""Where it is looked for in a motion that is what was asked for, and not what a stop has left of it."""


def reached_edge(effect: Effect, seen: np.ndarray, share: float = JUST_BELOW) -> float | None:
    """A displacement that its place hardly exceeds [m or rad]; None where the effect has none, or nothing was read.

    Args:
        effect: at its place.
        seen: displacements of the place, in any order, shape (T,) [m or rad].
        share: of the way that the place went.
    """
    reach = [p for p in effect.parameters if p.reach]
    if not reach or not seen.size or not np.any(seen):
        return None
    along = effect.towards(seen)
    furthest, nearest = float(along.max()), float(along.min())
    edge = furthest - (1.0 - share) * (furthest - min(nearest, 0.0))
    (p,) = reach
    return min(max(float(effect.towards(np.array([1.0]))[0]) * edge, p.lower), p.upper)


def started_there(effect: Effect, seen: np.ndarray) -> Effect:
    """The effect with its starts at these displacements; itself where it has none, or nothing was read.

    How hard it acts beyond them a screening tells in proportion.
    """
    edges = [e for share in SHARES if (e := reached_edge(effect, seen, share)) is not None]
    if not edges:
        return effect
    return effect.with_parameters(replace(p, starts=tuple(edges)) if p.reach else p for p in effect.parameters)
