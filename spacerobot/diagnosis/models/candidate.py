"""A model on trial: a baseline with effects in it, how it fits, and how it predicts what it was not fitted to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.hypothesis import Label, Site
from spacerobot.diagnosis.models.held_out import HeldOut


@dataclass(frozen=True, eq=False)
class Candidate:
    """A baseline with effects in it: how it fits, and how it predicts.

    Attributes:
        fits: to all trials, one a model.
        held_out: on unseen trials, one a model; empty where that was not tried.
    """

    fits: tuple[Fit, ...]
    held_out: tuple[HeldOut, ...] = ()

    @property
    def sites(self) -> tuple[Site, ...]:
        """Effects and places."""
        return self.fits[0].hypothesis.sites

    @property
    def label(self) -> Label:
        """Which effects where."""
        return self.fits[0].hypothesis.label

    @property
    def size(self) -> int:
        """Number of parameters that the effects bring along."""
        return sum(len(s.effect.parameters) for s in self.sites)

    @property
    def simplicity(self) -> tuple[int, int]:
        """(parameters, effects): of two models that predict alike, the one with less of both is meant."""
        return self.size, len(self.sites)

    @property
    def cost(self) -> float:
        """Of the fits together."""
        return sum(f.cost for f in self.fits)

    @property
    def error(self) -> float:
        """Weighted rms on unseen trials; infinite where it was not tried."""
        if not self.held_out:
            return np.inf
        return float(np.sqrt(np.mean([h.mean_square for h in self.held_out])))


def words(label: Label) -> str:
    """A set of effects in words, for progress and tables."""
    return " + ".join(f"{effect}@{where}" for effect, where in label) or "baseline"
