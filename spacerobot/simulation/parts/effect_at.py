"""An effect of the catalogue in a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from spacerobot.effects.effect import name_on
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.registry import effect
from spacerobot.support.errors import InputError


@dataclass(frozen=True)
class EffectAt:
    """An effect of the catalogue at a place, with values.

    Attributes:
        effect: its name.
        where: its place.
        parameters: name -> value; on a joint that turns, N may be written Nm and m rad.
    """

    effect: str
    where: str
    parameters: Mapping[str, float] = field(default_factory=dict)

    def apply(self, mechanism: Mechanism) -> Mechanism:
        """The mechanism with this effect in it.

        Raises:
            NotFoundError: unknown effect, place or parameter.
            InputError: a value missing, not a number, or outside its bounds.
        """
        found = effect(self.effect)
        angular = {name_on(p.name, True): p.name for p in found.parameters}
        turns = self.where in mechanism.ports and mechanism.angular(self.where)
        values = {}
        for name, value in self.parameters.items():
            if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
                raise InputError("not a number", given=value, where=f"{self.effect} at {self.where}: {name}")
            values[angular.get(name, name) if turns else name] = float(value)
        return found.apply(mechanism, self.where, values)
