"""An effect that grows or fades over the trials, by the same share of its first strength each time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from spacerobot.effects.effect import FORM, Effect, Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.sizes import Sizes

SUFFIX: Final = FORM + "trend"
"""What stands behind the name of an effect that changes."""

TREND = "trend_per_trial"
NUMBER = "trial_number"
"""Value that says which trial it is, from 0, in the order of the study."""

MOST = 0.5
"""Change from one trial to the next, at most."""


class Trend(Effect):
    """Another effect, its strength times 1 + trend (number of the trial)."""

    def __init__(self, steady: Effect) -> None:
        self.steady = steady
        for key in ("source", "replaces", "removes", "kind", "stands_for", "carried", "relative"):
            setattr(self, key, getattr(steady, key))
        given = {
            "name": steady.name + SUFFIX,
            "title": f"{steady.title} that changes over the trials",
            "phrase": f"{steady.phrase or steady.title} that changes over the trials",
            "formula": steady.formula,
            "refines": (steady.name, *(plainer + SUFFIX for plainer in steady.refines)),
            "parameters": (*steady.parameters, Parameter(TREND, "", 0.0, 0.02, -MOST, MOST, (0.0,), shape=True)),
        }
        for key, value in given.items():
            setattr(self, key, value)  # an instance is an effect of its own, as a class of the catalogue is

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Where the other could sit."""
        return self.steady.places(mechanism)

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """As the other effect, at its first strength."""
        return self.steady.implausible({p.name: values[p.name] for p in self.steady.parameters}, sizes)

    def in_trial(self, values: Mapping[str, float], number: float) -> dict[str, float]:
        """The other effect's values, as strong as it is in a trial, counted from 0."""
        strength = self.steady.strength
        share = 1.0 + values[TREND] * number
        changed = strength.null + (values[strength.name] - strength.null) * share
        inside = {p.name: values[p.name] for p in self.steady.parameters}
        inside[strength.name] = min(max(changed, strength.lower), strength.upper)
        return inside

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The other effect, as strong as it is in this trial."""
        return self.steady.edit(mechanism, where, self.in_trial(values, values.get(NUMBER, 0.0)))


def may_change(effect: Effect) -> bool:
    """Whether a trend of its strength means anything: of what acts all the time, and is null at a number."""
    return not (effect.once or effect.learned or effect.name.endswith(SUFFIX)) and abs(effect.strength.null) < 1e300
