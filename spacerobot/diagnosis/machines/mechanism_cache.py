"""Mechanisms that fits asked for lately: trials that nothing parts share theirs, and so do starts of one trial."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Hypothesis
from spacerobot.effects.mechanism import Mechanism
from spacerobot.simulation.reduced.run import Prepared, prepare

MOST = 256
"""Kept at a time: all columns of a Jacobian in every condition are some sixty."""


class MechanismCache:
    """Mechanisms by hypothesis, parameters, condition and overrides, ready to run."""

    def __init__(self) -> None:
        self._made: dict[object, tuple[Hypothesis, Mechanism]] = {}
        self._ready: dict[int, Prepared] = {}

    def mechanism(
        self,
        hypothesis: Hypothesis,
        z: np.ndarray,
        trial: TrialData,
        make: Callable[[], Mechanism],
        alone: bool = False,
    ) -> Mechanism:
        """The mechanism of a trial; made only if none like it was made lately.

        With `alone` only the windows of one recorded trial share theirs.
        """
        own = (*trial.overrides.items(), trial.recorded if alone or hypothesis.changes else "")
        condition = trial.condition if hypothesis.scattered else ""
        key = (id(hypothesis), z.tobytes(), condition, own, hypothesis.idle(trial.id))
        found = self._made.get(key)
        if found is None or found[0] is not hypothesis:
            if len(self._made) >= MOST:
                self._made, self._ready = {}, {}
            found = self._made[key] = hypothesis, make()
        return found[1]

    def prepared(self, mechanism: Mechanism) -> Prepared:
        """The mechanism ready to run."""
        found = self._ready.get(id(mechanism))
        if found is None or found.mechanism is not mechanism:
            found = prepare(mechanism)
            if len(self._ready) < MOST:
                self._ready[id(mechanism)] = found
        return found
