"""What a robot that moves shows beyond its small motions, to first order about a fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from spacerobot.diagnosis.terms.data import Block


class _Rows(NamedTuple):
    """What is added to a block of channels."""

    time: np.ndarray  # (T,) at which
    which: list[int]  # of its channels
    stacked: np.ndarray  # (R, C T) their rows, one channel after another


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
    _beside: dict[tuple[str, ...], _Rows] = field(init=False, default_factory=dict, repr=False)

    def weights(self, values: Mapping[str, float], initial: np.ndarray) -> np.ndarray:
        """Of the rows, at other values; shape (R,). An effect that is not among them is not there."""
        moved = [values.get(name, 0.0 if is_effect(name) else at) - at for name, at in self.values.items()]
        started = [float(initial[n] - self.initial[n]) for n in self.own]
        return np.array([1.0, *moved, *started])

    def add(self, block: Block, late: float, weights: np.ndarray, shown: np.ndarray) -> None:
        """To what small motions show of a block, shape (C, T), in place; its clock is late by so much [s]."""
        rows = self._rows(block)
        if not rows.which:
            return
        more = (weights @ rows.stacked).reshape(len(rows.which), -1)
        if late:
            more = np.array([np.interp(block.time - late, block.time, m) for m in more])
        shown[rows.which] += more

    def _rows(self, block: Block) -> _Rows:
        known = self._beside.get(block.channels)
        if known is None or known.time is not block.time:
            which = [k for k, channel in enumerate(block.channels) if channel in self.shown]
            rows = [self._at(block.time, *self.shown[block.channels[k]]) for k in which]
            stacked = np.concatenate(rows, axis=1) if rows else np.empty((0, 0))
            known = self._beside[block.channels] = _Rows(block.time, which, stacked)
        return known

    def _at(self, time: np.ndarray, at: np.ndarray, rows: np.ndarray) -> np.ndarray:
        return rows if np.array_equal(at, time) else np.array([np.interp(time, at, row) for row in rows])

    def touches(self, small: tuple[float, ...]) -> tuple[float, ...]:
        """When the whole robot touches, from when the small motions do."""
        return tuple(t + by for t, by in zip(small, (*self.later, *[0.0] * len(small)), strict=False))


def is_effect(name: str) -> bool:
    """Whether a value is an effect's, by its key."""
    return "@" in name


Beyond = Mapping[str, Bent]
"""Recorded trial -> what is added to it."""

NOTHING: Beyond = MappingProxyType({})
