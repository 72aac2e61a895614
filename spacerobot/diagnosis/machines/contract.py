"""What a fit asks of a machine: the wrist rig's answer and every other's are alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed, Hypothesis
from spacerobot.effects.mechanism import Mechanism


@dataclass(frozen=True)
class Nuisance:
    """A number of a trial's own: an initial value, or what a clock is late by.

    Attributes:
        coordinate: whose; of a clock, CLOCK and its name.
        rate: whether it is the velocity.
        guess: first value.
        scale: step of one unit in a fit.
    """

    coordinate: str
    rate: bool
    guess: float
    scale: float


CLOCK = "clock:"
"""Starts the name of a nuisance that is a clock's offset [s]: by how much its stream's readings are late."""


@dataclass(frozen=True)
class Predicted:
    """Predicted channels of a trial, block by block, and when something touched (never, where nothing can)."""

    blocks: tuple[np.ndarray, ...]  # (C, T) each, as the trial's blocks
    touches: tuple[float, ...] = ()
    late: tuple[float, ...] = ()  # by how much each block is late as its clock goes [s]; none where empty


class Baseline(Protocol):
    """What is believed of a machine, and the mechanism that this makes; all that locating needs.

    Attributes:
        base: values by dotted name, the trials' overrides apart.
        believed: values with their sigma, and what is unknown.
    """

    base: dict[str, float]
    believed: Believed

    def mechanism(self, values: Mapping[str, float], trial: TrialData, /) -> Mechanism:
        """The baseline of one trial with these values."""
        ...


class Machine(Baseline, Protocol):
    """Runs hypotheses too: a trial's start, and what its channels would show."""

    def trial_mechanism(self, hypothesis: Hypothesis, z: np.ndarray, trial: TrialData, /) -> Mechanism:
        """The mechanism of one trial with a hypothesis' effects in it."""
        ...

    def nuisances(self, trial: TrialData, /) -> tuple[Nuisance, ...]:
        """What is free in this trial alone."""
        ...

    def approach_start(self, trial: TrialData, initial: np.ndarray, residual: np.ndarray, /) -> np.ndarray:
        """Initial values to try again from, shape (N,), where a trial's cost has several minima."""
        ...

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray, /) -> Predicted:
        """What the trial's channels would show; `initial` has one value a nuisance, shape (N,)."""
        ...
