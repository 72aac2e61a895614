"""A stop that stands on one side alone: beyond a displacement, above it or below it, a spring pushes back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from spacerobot.effects.effect import Effect
from spacerobot.effects.form import FormOf
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force

SIDES = {"above": 1.0, "below": -1.0}
"""Which displacements it stands beyond, and which way that is."""


def force(d: float, v: float, aux: float, p: Any) -> float:
    """p = (stiffness, where it begins, way)."""
    over = p[2] * (d - p[1])
    return -p[2] * p[0] * over if over > 0.0 else 0.0


def edge(d: float, v: float, aux: float, p: Any) -> float:
    """Changes sign where it begins."""
    return p[2] * (d - p[1])


def energy(d: float, v: float, aux: float, p: Any) -> float:
    """Of what is pressed beyond."""
    over = max(0.0, p[2] * (d - p[1]))
    return 0.5 * p[0] * over * over


def slope(d: float, v: float, aux: float, p: Any) -> float:
    """None before it begins."""
    return p[0] if aux > 0.0 else 0.0


KERNEL = Kernel(force, edge, energy, slope)


class OneSided(FormOf):
    """A stop of a side: where it begins is a displacement with its sign, for a zero need not lie between two stops."""

    def __init__(self, plain: Effect, side: str) -> None:
        self.way = SIDES[side]
        super().__init__(
            plain,
            side,
            title=f"{plain.title} on one side",
            phrase=f"{plain.phrase} on one side",
            formula=r"f = -k_s\,(d - d_s) \text{ where that pushes back, else } 0",
            parameters=tuple(replace(p, lower=-p.upper) if p.reach else p for p in plain.parameters),
            settings={"kind": side},
        )

    def towards(self, displacement: np.ndarray) -> np.ndarray:
        """The displacement itself, counted in the stop's own way."""
        return self.way * displacement

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A spring that acts on one side."""
        p = (values["stiffness_N_m"], values["travel_m"], self.way)
        return mechanism.with_force(Force(f"{self.name} at {where}", where, KERNEL, p))
