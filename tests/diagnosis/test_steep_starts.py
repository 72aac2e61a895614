"""A trial's own value whose full step leads too far, whatever is done with what the trials share, is found still."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.normal_equations import Normal
from spacerobot.diagnosis.machines.contract import Nuisance, Predicted
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.effects.mechanism import Mechanism
from tests.diagnosis.test_pulls import BELIEVED, SIGMA, TIME, Lines

PLACE, WIDTH = 0.04, 0.01
"""Where the trial's own value is, and over what the readings feel it: beyond 1.4 widths a full step goes astray."""


class Steep(Lines):
    """x(t) = one sin(3 t) and y(t) = arctan of how far the trial's own value is off."""

    def nuisances(self, trial: TrialData) -> tuple[Nuisance, ...]:
        return (Nuisance("x0", False, 0.0, WIDTH),)

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> Predicted:
        return Predicted((_shown(mechanism.coordinates["one"].mass, float(initial[0])),))


def _shown(one: float, own: float) -> np.ndarray:
    return np.array([0.1 * one * np.sin(3.0 * TIME), np.full(TIME.size, 0.05 * np.arctan((own - PLACE) / WIDTH))])


def _found() -> float:
    value = _shown(BELIEVED["one.mass"], PLACE)
    weight = np.repeat(1.0 / SIGMA[:, None], TIME.size, axis=1)
    trial = TrialData("1", "a", {}, (Block("s", ("x", "y"), TIME, value, weight),), 0.0, 2.0)
    model = Steep((trial,))
    fit = Fitter(model, model.trials, careful=True).fit(hypothesis(model.believed, []))
    return float(fit.initials()["1"][0])


def test_it_is_found() -> None:
    assert _found() == pytest.approx(PLACE, abs=1e-3 * WIDTH)


def test_shorter_steps_of_what_is_shared_alone_do_not_find_it(monkeypatch: pytest.MonkeyPatch) -> None:
    step = Normal.step
    monkeypatch.setattr(Normal, "step", lambda self, *a, far, own_too: step(self, *a, far=far))
    assert abs(_found() - PLACE) > WIDTH
