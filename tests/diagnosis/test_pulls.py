"""An error bar is what it says: over many noisy recordings (truth - found) / sigma has mean 0 and variance 1.

Of the free values together (correlations count), and of the trials' own starts. A model of straight lines and sines,
so that the law is exact and a thousand fits take seconds.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.normal_equations import Normal
from spacerobot.diagnosis.machines.contract import Machine, Nuisance, Predicted, conditions_of
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed, hypothesis
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate
from spacerobot.effects.sizes import Sizes

TIME = np.linspace(0.0, 2.0, 60)
SIGMA = np.array([1e-3, 4e-3])
BELIEVED = {"one.mass": 2.0, "two.mass": 5.0}
DOUBT = {"one.mass": 0.003, "two.mass": 0.002}


class Lines(Machine):
    """x(t) = x0 + v0 t + one sin(3 t) + two t^2 / 10, and y(t) = x0 + one cos(2 t) / 5."""

    metric = "lines"

    def __init__(self, trials: tuple[TrialData, ...]) -> None:
        self.name, self.trials, self.base = "lines", trials, dict(BELIEVED)
        self.believed = Believed(self.base, DOUBT, {}, conditions_of(trials))
        self.sizes: Mapping[str, Sizes] = {}

    def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
        masses = {n: Coordinate(n, values[f"{n}.mass"]) for n in ("one", "two")}
        return Mechanism(coordinates=masses, ports={})

    def nuisances(self, trial: TrialData) -> tuple[Nuisance, ...]:
        return Nuisance("x0", False, 0.0, 0.01), Nuisance("v0", False, 0.0, 0.01)

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> Predicted:
        one, two = (mechanism.coordinates[n].mass for n in ("one", "two"))
        return Predicted((shown(one, two, initial),))


def shown(one: float, two: float, start: np.ndarray) -> np.ndarray:
    x0, v0 = start
    x = x0 + v0 * TIME + 0.1 * one * np.sin(3.0 * TIME) + 0.1 * two * TIME**2
    return np.array([x, x0 + 0.02 * one * np.cos(2.0 * TIME)])


def pulls(count: int, believed_sigma: float = 1.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Whitened errors of the values, shape (count, 2), their pulls one by one, and those of the starts (count, 4).

    `believed_sigma` is how far the truth lies from what is believed, in units of what is said of it.
    """
    rng = np.random.default_rng(11)
    together, alone, starts = [], [], []
    for _ in range(count):
        truth = {k: v * (1.0 + believed_sigma * DOUBT[k] * rng.standard_normal()) for k, v in BELIEVED.items()}
        trials, real = [], []
        for k in range(2):
            own = rng.normal(0.0, [0.02, 0.05])
            value = shown(truth["one.mass"], truth["two.mass"], own) + SIGMA[:, None] * rng.standard_normal((2, 60))
            weight = np.repeat(1.0 / SIGMA[:, None], 60, axis=1)
            trials.append(TrialData(f"{k}", "a", {}, (Block("s", ("x", "y"), TIME, value, weight),), 0.0, 2.0))
            real.append(own)
        model = Lines(tuple(trials))
        fitter = Fitter(model, model.trials, careful=True)
        made = hypothesis(model.believed, [])
        fit = fitter.fit(made)
        assert fit.converged
        assert fit.covariance is not None
        z = np.array([f.z(truth[f.key]) for f in made.free])
        error = fit.z - z
        together.append(np.linalg.solve(np.linalg.cholesky(fit.covariance), error))
        alone.append(error / np.sqrt(np.diag(fit.covariance)))
        state = fitter.state(made, fit.z, fit.initials())
        assert state is not None
        rows = []
        for trial, own in zip(model.trials, real, strict=True):
            j = fitter.jacobian(made, state, trial)
            inner, cross = j[:, 2:].T @ j[:, 2:], j[:, 2:].T @ j[:, :2]
            known = np.linalg.inv(inner)
            spread = known + known @ cross @ fit.covariance @ cross.T @ known
            rows.append((fit.trials[trial.id].initial - own) / 0.01 / np.sqrt(np.diag(spread)))
        starts.append(np.concatenate(rows))
    return np.array(together), np.array(alone), np.array(starts)


def near_one(values: np.ndarray, count: int) -> None:
    """Mean 0 and variance 1 within four deviations of what so many draws leave."""
    assert np.abs(values.mean(axis=0)).max() < 4.0 / np.sqrt(count)
    assert np.abs(values.var(axis=0) - 1.0).max() < 4.0 * np.sqrt(2.0 / count)


COUNT = 300


@pytest.mark.slow
def test_pulls_have_mean_zero_and_variance_one() -> None:
    together, alone, starts = pulls(COUNT)
    near_one(together, COUNT)
    near_one(alone, COUNT)
    near_one(starts, COUNT)
    assert np.abs(np.corrcoef(together.T)[0, 1]) < 4.0 / np.sqrt(COUNT)


def test_the_check_notices_a_belief_that_is_too_narrow() -> None:
    together, _, _ = pulls(80, believed_sigma=4.0)
    with pytest.raises(AssertionError):
        near_one(together, 80)


def test_a_contradiction_is_what_the_cost_falls_by_where_nothing_is_stated() -> None:
    """Exactly so where all is straight, however little of what is stated the readings take away."""
    rng, told = np.random.default_rng(2), []
    for noise in (0.3, 3.0, 30.0):
        trials = []
        for k in range(2):
            value = shown(1.9, 5.1, np.zeros(2)) + noise * SIGMA[:, None] * rng.standard_normal((2, 60))
            weight = np.repeat(1.0 / noise / SIGMA[:, None], 60, axis=1)
            trials.append(TrialData(f"{k}", "a", {}, (Block("s", ("x", "y"), TIME, value, weight),), 0.0, 2.0))
        model = Lines(tuple(trials))
        fitter = Fitter(model, model.trials, careful=True)
        held = fitter.fit(hypothesis(model.believed, []))
        for name, apart in held.contradictions().items():
            loose = fitter.fit(hypothesis(model.believed.free_of((name,)), []))
            assert apart**2 == pytest.approx(held.cost - loose.cost, rel=0.01, abs=0.05)
            assert name not in loose.contradictions()
            told.append(1.0 - (held.z[held.hypothesis.keys.index(name)] / apart) ** 2)
    assert min(told) < 0.1
    assert max(told) > 0.9


@pytest.mark.parametrize("sizes", [(3, 2, 1), (5, 4, 3), (1, 1, 6)])
def test_marginal_covariance_is_the_block_of_the_whole_inverse(sizes: tuple[int, int, int]) -> None:
    """Eliminating the trials' own values loses nothing: Schur's complement is the inverse's block."""
    shared, own, count = sizes
    rng = np.random.default_rng(5)
    root = rng.normal(size=(shared, shared))
    prior = root @ root.T  # what is believed of values may hang together
    jacobians = [rng.normal(size=(12, shared + own)) for _ in range(count)]
    residuals = [rng.normal(size=12) for _ in range(count)]
    z = rng.normal(size=shared)
    found = Normal.build(jacobians, residuals, z, prior)
    whole = np.zeros((shared + own * count,) * 2)
    right = np.zeros(shared + own * count)
    whole[:shared, :shared], right[:shared] = prior, prior @ z
    for k, (j, r) in enumerate(zip(jacobians, residuals, strict=True)):
        at = np.r_[:shared, shared + own * k : shared + own * (k + 1)]
        whole[np.ix_(at, at)] += j.T @ j
        right[at] += j.T @ r
    inverse = np.linalg.inv(whole)
    np.testing.assert_allclose(found.covariance(), inverse[:shared, :shared], rtol=1e-6, atol=1e-9)
    wide = np.full(shared, 1e9)
    dz, dn, promised = found.step(0.0, z, -wide, wide)
    best = -inverse @ right
    np.testing.assert_allclose(np.concatenate([dz, *dn]), best, rtol=1e-5, atol=1e-7)
    assert promised == pytest.approx(float(right @ inverse @ right), rel=1e-5)
