"""A model on trial: a baseline with effects in it, how it fits, and how it predicts what it was not fitted to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.selection.held_out import HeldOut
from spacerobot.diagnosis.terms.hypothesis import Label, Site
from spacerobot.support.errors import SimulationError


@dataclass(frozen=True, eq=False)
class Candidate:
    """A baseline with effects in it: how it fits, and how it predicts.

    Attributes:
        fit: to all trials.
        held_out: on unseen trials; None where that was not tried, or could not be.
        loud: how many times the noise that is stated of a channel it leaves there, at most; 0 where none is stated.
    """

    fit: Fit
    held_out: HeldOut | None = None
    loud: float = 0.0

    @property
    def sites(self) -> tuple[Site, ...]:
        """Effects and places."""
        return self.fit.hypothesis.sites

    @property
    def label(self) -> Label:
        """Which effects where."""
        return self.fit.hypothesis.label

    @property
    def size(self) -> int:
        """Number of parameters that the effects bring along; which of several forms an effect has is one too."""
        return sum(len(s.effect.parameters) + (s.effect.choices > 1) for s in self.sites)

    @property
    def simplicity(self) -> tuple[int, int]:
        """(parameters, effects): of two models that predict alike, the one with less of both is meant."""
        return self.size, len(self.sites)

    @property
    def cost(self) -> float:
        """Of the fit."""
        return self.fit.cost

    @property
    def error(self) -> float:
        """Weighted rms on unseen trials, of all channels together; infinite where it was not tried."""
        return np.inf if self.held_out is None else self.held_out.together


def words(label: Label) -> str:
    """A set of effects in words, for progress and tables."""
    return " + ".join(f"{effect}@{where}" for effect, where in label) or "baseline"


def tried(one: Candidate) -> HeldOut:
    """How a candidate predicts unseen trials.

    Raises:
        SimulationError: it cannot.
    """
    if one.held_out is None:
        raise SimulationError(f"{words(one.label)} cannot predict trials that it was not fitted to")
    return one.held_out
