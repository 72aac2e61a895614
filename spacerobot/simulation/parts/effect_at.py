"""An effect of the catalogue in a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from spacerobot.effects.effect import Effect, name_on
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.registry import effect
from spacerobot.support.errors import InputError


@dataclass(frozen=True)
class EffectAt:
    """An effect of the catalogue at a place, with values.

    Attributes:
        effect: its name.
        where: its place.
        parameters: name -> value, of a filter order and kind too, of a stop on one side its kind; on a joint that
            turns, N may be Nm and m rad.
    """

    effect: str
    where: str
    parameters: Mapping[str, float | str] = field(default_factory=dict)

    def apply(self, mechanism: Mechanism) -> Mechanism:
        """The mechanism with this effect in it.

        Raises:
            NotFoundError: unknown effect, place or parameter.
            InputError: a value missing, not a number, or outside its bounds.
        """
        found, parameters = self._formed()
        angular = {name_on(p.name, True): p.name for p in found.parameters}
        turns = self.where in mechanism.ports and mechanism.angular(self.where)
        values = {}
        for name, value in parameters.items():
            if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
                raise InputError("not a number", given=value, where=f"{self.effect} at {self.where}: {name}")
            values[angular.get(name, name) if turns else name] = float(value)
        return found.apply(mechanism, self.where, values)

    def _formed(self) -> tuple[Effect, dict[str, float | str]]:
        """The effect in the form that order and kind state, and the other parameters."""
        rest = dict(self.parameters)
        found = effect(self.effect)
        known = found.in_form(found.forms[0]).settings.keys() if found.forms else set()
        if not known & rest.keys():
            return found, rest
        if "order" not in known:
            return found.in_form(str(rest.pop("kind"))), rest
        order, kind = rest.pop("order", 1.0), rest.pop("kind", found.forms[0].split("_", 1)[1])
        given = f"{order:g}_{kind}" if isinstance(order, int | float) else f"{order}_{kind}"
        if order == 1 and any(form.endswith(f"_{kind}") for form in found.forms):
            return found, rest
        if given not in found.forms:
            raise InputError(
                "no such form of the effect",
                given=f"order {order}, kind {kind}",
                valid=", ".join(["order 1", *(f.replace("_", " ", 1) for f in found.forms)]),
                where=f"{self.effect} at {self.where}",
            )
        return found.in_form(given), rest
