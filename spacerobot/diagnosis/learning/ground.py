"""What a law is learned on: a machine and its trials, as a rig's workshop or a part's bench has them."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.learned import Variable


class Ground(Protocol):
    """A machine and the trials that it is fitted to, under the weights of these fits."""

    @property
    def model(self) -> Machine:
        """What is fitted."""
        ...

    @property
    def trials(self) -> tuple[TrialData, ...]:
        """To what."""
        ...


def visited(ground: Ground, fit: Fit, port: str) -> dict[Variable, tuple[float, float]]:
    """Ranges of a port's displacement and rate in a fit's trials, of what it remembers and of what presses there.

    What the machine does not know of its ports has no range.
    """
    seen: dict[Variable, list[np.ndarray]] = {}
    for trial in ground.trials:
        mechanism = ground.model.trial_mechanism(fit.hypothesis, fit.z, trial)
        for of, value in ground.model.travelled(port, mechanism, trial, fit.trials[trial.id].initial).items():
            seen.setdefault(of, []).append(value)
    return {of: (float(min(x.min() for x in all_)), float(max(x.max() for x in all_))) for of, all_ in seen.items()}
