"""What a robot that moves shows beyond its small motions, to first order about a fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np


@dataclass(frozen=True, eq=False)
class Bent:
    """Of one trial: what is to be added to its small motions.

    Attributes:
        values: of the rig and of effects where it was found, by name and by key; those along which it changes.
        initial: values of the trial's own where it was found, one a nuisance.
        own: which of those it changes along.
        shown: channel -> times, shape (T,), and rows, shape (1 + len(values) + len(own), T): what is added there, then
            how that changes with each of `values` and of `own`.
        later: by how much the whole robot's touches come later than those of the small motions, one each [s].
    """

    values: Mapping[str, float]
    initial: np.ndarray
    own: tuple[int, ...]
    shown: Mapping[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    later: tuple[float, ...] = ()

    def weights(self, values: Mapping[str, float], initial: np.ndarray) -> np.ndarray:
        """Of the rows, at other values; shape (R,). An effect that is not among them is not there."""
        moved = [values.get(name, 0.0 if is_effect(name) else at) - at for name, at in self.values.items()]
        started = [float(initial[n] - self.initial[n]) for n in self.own]
        return np.array([1.0, *moved, *started])

    def add(self, channel: str, time: np.ndarray, weights: np.ndarray, row: np.ndarray) -> None:
        """To what small motions show of a channel at some times, shape (T,), in place."""
        if channel not in self.shown:
            return
        at, rows = self.shown[channel]
        more = weights @ rows
        row += more if at is time or np.array_equal(at, time) else np.interp(time, at, more)

    def touches(self, small: tuple[float, ...]) -> tuple[float, ...]:
        """When the whole robot touches, from when the small motions do."""
        return tuple(t + by for t, by in zip(small, (*self.later, *[0.0] * len(small)), strict=False))


def is_effect(name: str) -> bool:
    """Whether a value is an effect's, by its key."""
    return "@" in name


Beyond = Mapping[str, Bent]
"""Recorded trial -> what is added to it."""

NOTHING: Beyond = MappingProxyType({})
