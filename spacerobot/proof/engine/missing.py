"""A piece of physics that a campaign hides: name, place, numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
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
    """

    effect: str
    where: str
    values: Mapping[str, float]
    trials: tuple[int, ...] | None = None

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
        if self.trials is not None:
            found["trials"] = list(self.trials)
        return found
