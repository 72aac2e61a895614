"""One trial with everything that its balances are tested with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from spacerobot.diagnosis.locate.balances import Balance, balances
from spacerobot.diagnosis.locate.beliefs import deviations, directions
from spacerobot.diagnosis.locate.samples import Integral
from spacerobot.diagnosis.locate.weak_trial import WeakTrial
from spacerobot.diagnosis.locate.whitening import Whitener, noise, with_directions
from spacerobot.diagnosis.machines.contract import Baseline
from spacerobot.diagnosis.terms.data import TrialData


@dataclass(frozen=True, eq=False)
class Tested:
    """Rows of one or several balances in units of their noise. R rows.

    Attributes:
        white: residual, shape (R,), sensor noise and believed values' sigmas whitened.
        whiten: the same for patterns; they lose what a wrong believed value could imitate.
        exact: whitens by sensor noise alone.
        residual: as it is.
    """

    white: np.ndarray
    whiten: Whitener
    exact: Whitener
    residual: Integral

    @classmethod
    def of(cls, weak: WeakTrial, residual: Integral, wrong: Mapping[str, np.ndarray]) -> Tested:
        """From integrals, shape (R,), and the changes of one sigma of each believed value, shape (R,) each."""
        covariance = noise(weak, residual)
        whiten = Whitener(with_directions(covariance, wrong))
        return cls(whiten(residual.value), whiten, Whitener(covariance), residual)


class Prepared:
    """One trial, ready to be tested.

    Attributes:
        weak: test functions and motion.
        mechanism: the baseline with the values balanced with.
        found: its balances by name.
        wrong: balance -> value's name -> change of the residual by one standard deviation, shape (I,).
    """

    def __init__(
        self, model: Baseline, trial: TrialData, values: Mapping[str, float], trials: Sequence[TrialData]
    ) -> None:
        self.mechanism = model.mechanism(values, trial)
        self.weak = WeakTrial(trial, self.mechanism)
        self.found: dict[str, Balance] = balances(self.weak, self.mechanism)
        clean = self.weak.without_noise()
        self.wrong = directions(
            values,
            deviations(model.believed, values, trials),
            balances(clean, self.mechanism),
            lambda v: balances(clean, model.mechanism(v, trial)),
        )
        self._tested: dict[str, Tested] = {}

    def tested(self, name: str) -> Tested:
        """One balance's kept rows, whitened."""
        if name not in self._tested:
            balance = self.found[name]
            wrong = {k: v[balance.keep] for k, v in self.wrong[name].items()}
            self._tested[name] = Tested.of(self.weak, balance.residual.rows(balance.keep), wrong)
        return self._tested[name]

    def seen(self, name: str, patterns: np.ndarray) -> np.ndarray:
        """Patterns at the nodes, shape (Q, K), as one balance's kept rows see them, shape (R, K)."""
        return np.asarray(self.weak.integral(0, patterns)[self.found[name].keep])

    @cached_property
    def suspects(self) -> dict[str, tuple[str, ...]]:
        """Sensors to test, with channels: all but the one that shows most positions, against which they are held."""
        listed = {n: tuple(c for c in cs if c in self.weak.series) for n, cs in self.mechanism.sensors.items()}
        listed = {name: channels for name, channels in listed.items() if channels}
        if not listed:
            return {}
        reference = max(listed, key=lambda n: sum(c in self.weak.observers.rows for c in listed[n]))
        return {n: c for n, c in listed.items() if n != reference}
