"""A piece of physics that a campaign hides: name, place, numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

SENSORS = ("force_sensor", "mocap")


@dataclass(frozen=True)
class Missing:
    """One left-out effect, named as verdicts name it.

    Attributes:
        effect: name, of the catalogue or of an outsider.
        where: place.
        values: parameters, SI.
        trials: indices of the trials that show it; None for all.
        trend: of an effect of one number, the share of its first strength that it gains from trial to trial.
        form: order and kind of a filter.
    """

    effect: str
    where: str
    values: Mapping[str, float]
    trials: tuple[int, ...] | None = None
    trend: float = 0.0
    form: tuple[int, str] = (1, "butterworth")

    def at(self, trial: int) -> Missing:
        """As it is in a trial, counted from 0: its one number's distance from nothing grows or fades."""
        if not self.trend:
            return self
        ((name, value),) = self.values.items()
        null = 1.0 if name == "factor" else 0.0
        return replace(self, values={name: null + (value - null) * (1.0 + self.trend * trial)}, trend=0.0)

    @property
    def label(self) -> tuple[str, str]:
        """(effect, where)."""
        return self.effect, self.where

    @property
    def at_sensor(self) -> bool:
        """Whether a sensor does it, not the rig."""
        return self.where in SENSORS

    def shows(self, trial: int) -> bool:
        """Whether a trial, counted from 0, has it."""
        return self.trials is None or trial in self.trials

    def as_json(self) -> dict[str, Any]:
        """As truth files hold it."""
        found: dict[str, Any] = {"effect": self.effect, "where": self.where, **self.values}
        if self.trend:
            found["trend_per_trial"] = self.trend
        if self.form[0] > 1:
            found["order"], found["kind"] = float(self.form[0]), self.form[1]
        if self.trials is not None:
            found["trials"] = list(self.trials)
        return found
