"""An interval is as wide as the noise, its colour, the minima beside it and the law's own defects ask for, no wider."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lfilter

from spacerobot.diagnosis.fitting import profile
from spacerobot.diagnosis.fitting.colour import inflations
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.profile import LEVEL_95, _Profiler
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.machines.contract import Nuisance, Predicted
from spacerobot.diagnosis.selection import intervals
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.decision import STAND_IN
from spacerobot.diagnosis.terms.hypothesis import Site, hypothesis
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.registry import all_effects
from tests.diagnosis.rigs import write_study
from tests.diagnosis.test_pulls import BELIEVED, DOUBT, Lines
from tests.diagnosis.test_values_of_a_trial import BELIEVED as RIG

TIME = np.linspace(0.0, 2.0, 240)
SIGMA = np.array([1e-3, 4e-3])
WHITE, COLOURED, LOUD = (0.0, 1.0), (0.25, 1.0), (0.0, 1.5)
"""Share of the noise's variance that remembers four fifths of itself from sample to sample, and its size."""


def noise(rng: np.random.Generator, shape: tuple[int, ...], kind: tuple[float, float]) -> np.ndarray:
    share, size = kind
    slow = lfilter([0.6], [1.0, -0.8], rng.standard_normal((*shape[:-1], shape[-1] + 60)))[..., 60:]
    return size * (math.sqrt(1.0 - share) * rng.standard_normal(shape) + math.sqrt(share) * slow)


class Slow(Lines):
    """A slow drift that "one" makes, and a ring that "two" makes: the one feels all of the colour, the other little."""

    def nuisances(self, trial: TrialData) -> tuple[Nuisance, ...]:
        return Nuisance("x0", False, 0.0, 0.01), Nuisance("v0", False, 0.0, 0.01)

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> Predicted:
        one, two = (mechanism.coordinates[n].mass for n in ("one", "two"))
        return Predicted((_shown(one, two, initial),))


def _shown(one: float, two: float, start: np.ndarray) -> np.ndarray:
    drift = start[0] + start[1] * TIME + 0.05 * one * np.sin(4.0 * TIME)
    return np.array([drift, start[0] + 0.02 * two * np.sin(250.0 * TIME)])


def pulls(kind: tuple[float, float], count: int = 150) -> tuple[np.ndarray, np.ndarray]:
    """(truth - found) over the curvature's error, and the inflations, shape (count, 2) each."""
    rng, off, by = np.random.default_rng(4), [], []
    for _ in range(count):
        truth = {k: v * (1.0 + DOUBT[k] * rng.standard_normal()) for k, v in BELIEVED.items()}
        trials = []
        for k in range(3):
            value = _shown(truth["one.mass"], truth["two.mass"], rng.normal(0.0, [0.02, 0.05]))
            value = value + SIGMA[:, None] * noise(rng, (2, TIME.size), kind)
            weight = np.repeat(1.0 / SIGMA[:, None], TIME.size, axis=1)
            trials.append(TrialData(f"{k}", "a", {}, (Block("s", ("x", "y"), TIME, value, weight),), 0.0, 2.0))
        model = Slow(tuple(trials))
        fitter = Fitter(model, model.trials, careful=True)
        fit = fitter.fit(hypothesis(model.believed, []))
        assert fit.covariance is not None
        z = np.array([f.z(truth[f.key]) for f in fit.hypothesis.free])
        off.append((fit.z - z) / np.sqrt(np.diag(fit.covariance)))
        found = inflations(fitter, fit)
        by.append([found[f.key] for f in fit.hypothesis.free])
    return np.array(off), np.array(by)


@pytest.mark.parametrize("kind", [WHITE, COLOURED, LOUD])
def test_pulls_have_variance_one_whatever_the_noise(kind: tuple[float, float]) -> None:
    off, by = pulls(kind)
    assert (by >= 1.0).all()
    assert np.abs((off / np.sqrt(by)).var(axis=0) - 1.0).max() < 4.0 * math.sqrt(2.0 / len(off))
    if kind is WHITE:
        assert np.median(by) < 1.1  # nobody pays for a colour that is not there
    if kind is COLOURED:
        slow, fast = np.median(by, axis=0)
        assert slow > 1.5 * fast  # a ring averages out, a drift does not
        with pytest.raises(
            AssertionError
        ):  # nor would one number for all, from one lag to the next, do for the slow one
            lag = 0.25 * 0.8
            assert abs((off[:, 0] / math.sqrt((1.0 + lag) / (1.0 - lag))).var() - 1.0) < 4.0 * math.sqrt(2.0 / len(off))
    if kind is LOUD:
        assert off.var(axis=0).max() > 1.0 + 4.0 * math.sqrt(2.0 / len(off))  # as stated, it is no error bar


@pytest.mark.parametrize("inflation", [1.0, 4.0])
def test_noise_that_counts_for_less_makes_intervals_wider(inflation: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a parabola: by the root of the inflation."""
    free = SimpleNamespace(key="k", bounds=(-math.inf, math.inf), value=float, z=float, lower=-math.inf, upper=math.inf)
    made = SimpleNamespace(free=(free,), sites=())

    def held(_: Any, index: int, at: float) -> Any:
        return SimpleNamespace(free=(SimpleNamespace(key="k", lower=at),))

    class Parabola:
        def fit(self, hypothesis: Any, **_: Any) -> Any:
            return SimpleNamespace(cost=10.0 + hypothesis.free[0].lower ** 2)

    monkeypatch.setattr(profile, "_held", held)
    monkeypatch.setattr(profile, "known_rows", lambda *_: None)
    fit = SimpleNamespace(hypothesis=made, z=np.zeros(1), covariance=None, cost=10.0, values=dict, initials=dict)
    low, high = _Profiler(cast(Fitter, Parabola()), cast(Fit, fit), 0, inflation).profile().ends
    assert high == pytest.approx(math.sqrt(inflation * LEVEL_95), rel=0.06)
    assert low == pytest.approx(-high)


class Walled(_Profiler):
    """A parabola that meets the level at one, and beyond a wall a place that fits again."""

    def __init__(self, place: float, depth: float, covariance: float) -> None:
        free = SimpleNamespace(
            key="k", bounds=(-math.inf, math.inf), value=float, z=float, lower=-math.inf, upper=math.inf
        )
        made = SimpleNamespace(free=(free,), sites=())
        fit = SimpleNamespace(hypothesis=made, z=np.zeros(1), covariance=np.array([[covariance / LEVEL_95]]))
        super().__init__(cast(Fitter, None), cast(Fit, fit), 0, 1.0)
        self.place, self.depth = place, depth

    def _rise(self, at: float) -> float:
        beyond = abs(at) > 0.99 * self.place
        return (
            self.depth if beyond and abs(at) < 1.7 * self.place else LEVEL_95 * at**2 * (9.0 if abs(at) > 1.0 else 1.0)
        )


@given(place=st.floats(1.2, 1.6), depth=st.floats(-50.0, 0.9 * LEVEL_95), wide=st.floats(0.3, 3.0))
def test_an_interval_holds_what_fits_again_beyond_a_wall(place: float, depth: float, wide: float) -> None:
    low, high = Walled(place, depth, wide if not 0.9 < wide < 1.1 else 0.5).profile().ends
    assert high >= place
    assert low <= -place
    low, high = Walled(place, 5.0 * LEVEL_95, wide).profile().ends  # where nothing fits there, it is not widened
    assert -low == pytest.approx(high)
    assert high < 2.0


def test_a_better_minimum_that_a_profile_meets_takes_the_place_of_the_fit(tmp_path: Path) -> None:
    """A knock placed in the wrong moment fits nearly; its own profile passes the right one."""
    label, when = (("external_impulse", "target"),), "external_impulse@target.time_s"
    size = {"external_impulse@target.impulse_Ns": -0.02}
    shop = Workshop(write_study(tmp_path, planted=[(*label[0], {"impulse_Ns": -0.02, "time_s": 0.5})]))
    right = shop.run(Task(label, {**size, when: 0.5}))
    wrong = shop.run(Task(label, {**size, when: 0.53}))
    assert right is not None
    assert wrong is not None
    assert right.cost + 10.0 < wrong.cost < 1.02 * right.cost  # no test of what is left would notice
    with Pool(shop, 1) as pool:
        better = wrong
        for _ in range(intervals.AGAIN):
            met = intervals._better(pool, better, {when: intervals._profiled(shop, better, when, 1.0)})
            better = better if met is None else met
        assert better.cost < right.cost + LEVEL_95
        assert better.values()[when] == pytest.approx(0.5, abs=2e-3)
        assert intervals._better(pool, right, {when: intervals._profiled(shop, right, when, 1.0)}) is None


@pytest.mark.parametrize("effect", all_effects().values(), ids=lambda e: e.name)
def test_a_defect_is_granted_to_how_a_stand_in_acts_and_to_nothing_else(effect: Any) -> None:
    """In proportion to what it explains beside the rest of its set, once more than that: never to a law of its own."""
    site, other = Site(effect, "arm"), Site(all_effects()["coulomb_friction"], "wrist")
    both, rest = hypothesis(RIG, [site, other]), hypothesis(RIG, [other])
    chosen = cast(Any, SimpleNamespace(hypothesis=both, cost=100.0))
    found = Found(cast(Any, SimpleNamespace(hypothesis=hypothesis(RIG, []), cost=5100.0)))
    found.fits[rest.label] = cast(Any, SimpleNamespace(hypothesis=rest, cost=1100.0))
    for parameter in effect.parameters:
        wanted = STAND_IN * 1000.0 if effect.stands_for and parameter.shape else 0.0
        assert intervals.granted(found, chosen, site.key(parameter.name)) == pytest.approx(wanted)
    assert intervals.granted(found, chosen, other.key("force_N")) == 0.0
