"""Which numbers a trial is simulated with, and which of its samples count: believed, overridden, scattered, removed."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.noise import rms_of, squares_of
from spacerobot.diagnosis.fitting.profile import LEVEL_95, profile_interval
from spacerobot.diagnosis.selection.penalty import score
from spacerobot.diagnosis.terms.data import Block, TrialData, piece_id, recorded_id, trial_data
from spacerobot.diagnosis.terms.decision import PENALTY
from spacerobot.diagnosis.terms.hypothesis import LOOSE, Believed, Site, hypothesis
from spacerobot.effects.registry import effect
from tests.diagnosis.rigs import write_study
from tests.diagnosis.test_pulls import SIGMA, TIME, Lines, shown

BELIEVED = Believed(
    {"target.mass": 10.0, "wrist.stiffness": 1000.0, "contact.damping": 30.0, "wrist.damping": 2.0},
    {"target.mass": 0.02, "wrist.stiffness": 0.05},
    {"wrist.stiffness": 0.01},
    ("light", "heavy"),
    {"contact.damping": 30.0},
)


def values(z: dict[str, float], condition: str = "light", **overrides: float) -> dict[str, float]:
    made = hypothesis(BELIEVED, [])
    at = np.array([z.get(f.key, 0.0) for f in made.free])
    return made.trial_values(
        at, dict(BELIEVED.values), condition, {k.replace("_", ".", 1): v for k, v in overrides.items()}
    )


def test_a_believed_value_moves_by_so_many_of_its_sigmas() -> None:
    assert values({})["wrist.stiffness"] == 1000.0
    assert values({"wrist.stiffness": 2.0})["wrist.stiffness"] == pytest.approx(1000.0 * (1.0 + 2.0 * 0.05))


def test_a_deviation_is_one_for_the_whole_study_also_where_a_trial_has_its_own_value() -> None:
    """A scale that shows two per cent too much does so for the light target as for the heavy one."""
    for own in (10.0, 4.0, 35.0):
        assert values({"target.mass": 1.5}, target_mass=own)["target.mass"] == pytest.approx(own * (1.0 + 1.5 * 0.02))


def test_a_scatter_is_of_its_own_condition_alone() -> None:
    z = {"light|wrist.stiffness": 3.0}
    assert values(z, "light")["wrist.stiffness"] == pytest.approx(1030.0)
    assert values(z, "heavy")["wrist.stiffness"] == pytest.approx(1000.0)
    both = {**z, "wrist.stiffness": 1.0}
    assert values(both, "light")["wrist.stiffness"] == pytest.approx(
        1000.0 * (1.0 + 0.05 + 0.03)
    )  # shares of what is stated


def test_a_belief_set_free_counts_for_next_to_nothing_and_is_told_in_its_own_sigmas() -> None:
    free = BELIEVED.free_of(("wrist.stiffness",))
    made = hypothesis(free, [])
    by = {f.key: f for f in made.free}
    assert by["wrist.stiffness"].step == pytest.approx(LOOSE * 50.0)
    assert by["target.mass"].step == pytest.approx(0.2)
    z = np.array([1.0 if f.key == "wrist.stiffness" else 0.0 for f in made.free])
    assert made.sigmas(z)["wrist.stiffness"] == pytest.approx(LOOSE)
    assert BELIEVED.free_of(()) == BELIEVED


def test_what_an_effect_stands_for_is_taken_away() -> None:
    made = hypothesis(BELIEVED, [Site(effect("hunt_crossley"), "contact")])
    found = made.trial_values(made.start(), dict(BELIEVED.values), "light", {})
    assert found["contact.damping"] == 0.0
    assert "contact.damping" not in made.keys
    assert found["wrist.damping"] == 2.0


def test_an_effect_of_one_trial_acts_there_alone() -> None:
    knock = Site(effect("external_impulse"), "target", ("02",))
    made = hypothesis(BELIEVED, [knock])
    assert made.acting("02") == (knock,)
    assert made.acting("01") == ()
    assert made.idle("01") == {"external_impulse@target.impulse_Ns", "external_impulse@target.time_s"}
    assert not made.idle("02")


def test_what_was_not_read_weighs_nothing(tmp_path: Any) -> None:
    study = write_study(tmp_path, masses=(9.0,), speeds=(0.1,))
    name = next(iter(study.recording(study.trials[0])))
    series = study.recording(study.trials[0])[name]
    gone = np.arange(len(series.time)) % 5 == 2
    series.value[gone], series.valid[gone] = np.nan, False
    (trial,) = trial_data(study)
    time, value, weight = trial.channel(name)
    np.testing.assert_array_equal(time, series.time[~gone])
    np.testing.assert_array_equal(value, series.value[~gone])
    np.testing.assert_allclose(weight, 1.0 / series.sigma)
    assert trial.samples == sum(int(np.count_nonzero(b.weight)) for b in trial.blocks)
    assert all(np.isfinite(b.value).all() for b in trial.blocks)


def lines(size: float = 1.0, lost: slice | None = None, truth: tuple[float, float] = (2.004, 4.99)) -> Lines:
    """A trial whose stated noise is `size` times the true one, some of it not read."""
    rng = np.random.default_rng(2)
    value = shown(*truth, np.array([0.01, -0.03])) + SIGMA[:, None] * rng.standard_normal((2, 60))
    weight = np.repeat(1.0 / SIGMA[:, None] / size, 60, axis=1)
    if lost is not None:
        value[:, lost], weight[:, lost] = 1e3, 0.0
    return Lines((TrialData("0", "a", {}, (Block("s", ("x", "y"), TIME, value, weight),), 0.0, 2.0),))


def fitted(model: Lines) -> tuple[Fitter, Fit]:
    fitter = Fitter(model, model.trials, careful=True)
    return fitter, fitter.fit(hypothesis(model.believed, []))


def test_noise_that_is_stated_twice_as_large_makes_a_quarter_of_chi_squared() -> None:
    (_, one), (_, two) = fitted(lines()), fitted(lines(2.0))
    state = Fitter(lines(2.0), lines(2.0).trials).state(one.hypothesis, one.z, one.initials())
    assert state is not None
    assert state.chi2() == pytest.approx(one.chi2 / 4.0, rel=1e-9)
    assert two.covariance is not None
    assert one.covariance is not None
    assert (np.diag(two.covariance) > np.diag(one.covariance)).all()
    assert one.cost == pytest.approx(one.chi2 + float(one.z @ one.z), rel=1e-12)
    assert one.chi2 == pytest.approx(120, abs=4.0 * np.sqrt(240.0))


def test_what_weighs_nothing_moves_nothing() -> None:
    _, fit = fitted(lines(lost=slice(20, 30)))
    assert fit.samples == 100
    assert fit.chi2 < 200.0
    assert np.abs(fit.z).max() < 3.0


@pytest.mark.parametrize("inflation", [1.0, 4.0])
@pytest.mark.parametrize("key", ["one.mass", "two.mass"])
def test_an_interval_of_a_straight_model_is_that_of_its_covariance(key: str, inflation: float) -> None:
    """1.96 sigma to both sides, twice as wide where the noise has four times the variance."""
    fitter, fit = fitted(lines())
    assert fit.covariance is not None
    k = fit.hypothesis.keys.index(key)
    half = np.sqrt(LEVEL_95 * inflation * fit.covariance[k, k])
    low, high = profile_interval(fitter, fit, key, inflation)
    free = fit.hypothesis.free[k]
    assert (low, high) == (
        pytest.approx(free.value(fit.z[k] - half), abs=0.06 * half * free.step),
        pytest.approx(free.value(fit.z[k] + half), abs=0.06 * half * free.step),
    )


def test_a_score_counts_what_was_chosen() -> None:
    """A parameter of an effect, the choice of one trial, and a belief that is given up cost alike."""
    base = SimpleNamespace(cost=100.0, hypothesis=hypothesis(BELIEVED, []))
    rub = SimpleNamespace(cost=100.0, hypothesis=hypothesis(BELIEVED, [Site(effect("coulomb_friction"), "wrist")]))
    once = SimpleNamespace(
        cost=100.0, hypothesis=hypothesis(BELIEVED, [Site(effect("coulomb_friction"), "wrist", ("02",))])
    )
    given = SimpleNamespace(cost=100.0, hypothesis=hypothesis(BELIEVED.free_of(("target.mass",)), []))
    found = [score(f) - 100.0 for f in (base, rub, once, given)]  # type: ignore[arg-type]
    assert found == [0.0, PENALTY, 2.0 * PENALTY, PENALTY]
    assert score(rub, 4.0) == 25.0 + PENALTY  # type: ignore[arg-type]


def test_residuals_are_told_in_the_channels_own_unit() -> None:
    rng = np.random.default_rng(7)
    weight = np.stack([np.full(50, 10.0), np.full(50, 0.5)])
    weight[0, :10] = 0.0
    block = Block("s", ("a", "b"), np.arange(50.0), np.zeros((2, 50)), weight)
    trial = TrialData("0", "all", {}, (block,), 0.0, 50.0)
    error = rng.normal(size=(2, 50))
    residual = (error * weight).ravel()
    found = squares_of({"0": residual}, [trial])
    assert found["a"] == (pytest.approx(float(error[0, 10:] @ error[0, 10:])), 40)
    assert found["b"] == (pytest.approx(float(error[1] @ error[1])), 50)
    assert rms_of({"0": residual}, [trial])["b"] == pytest.approx(0.5 * np.sqrt(np.mean(error[1] ** 2)))


def test_what_the_readings_say_nothing_of_goes_back_to_what_is_believed() -> None:
    """Readings without weight leave the belief, its width and no cost, wherever the fit began."""
    model = lines(1e9)
    made = hypothesis(model.believed, [])
    away = {f.key: f.value(3.0) for f in made.free}
    fit = Fitter(model, model.trials, careful=True).fit(made, warm=away)
    assert np.abs(fit.z).max() < 1e-3
    assert fit.covariance is not None
    np.testing.assert_allclose(fit.covariance, np.eye(2), atol=1e-3)
    assert fit.cost < 1e-3


@pytest.mark.parametrize("size", [5.0, 15.0, 40.0])
def test_a_fit_ends_at_one_place_wherever_it_began(size: float) -> None:
    """Also where every step towards what is believed costs the readings something."""
    model = lines(size, truth=(2.024, 4.96))  # four of its sigmas off what is believed
    made = hypothesis(model.believed, [])
    ends = []
    for z in (-4.0, 0.0, 4.0):
        start = {f.key: f.value(z * sign) for f, sign in zip(made.free, (1.0, -1.0), strict=True)}
        own = {"0": np.array([0.01, -0.03])}  # already where they belong: nothing but the values has to move
        fit = Fitter(model, model.trials, careful=True).fit(made, warm=start, initials=own)
        ends.append(fit.z)
    assert np.abs(ends[0] - ends[1]).max() < 0.05
    assert np.abs(ends[2] - ends[1]).max() < 0.05


def test_a_belief_and_readings_that_agree_meet_where_their_weights_say() -> None:
    """The best of a straight model is the mean of both, weighed by their information."""
    model = lines()
    fitter, fit = fitted(model)
    state = fitter.state(fit.hypothesis, fit.z, fit.initials())
    assert state is not None
    (trial,) = model.trials
    jacobian = fitter.jacobian(fit.hypothesis, state, trial)
    slope = jacobian.T @ state.raw[trial.id] + np.r_[fit.z, np.zeros(2)]
    size = np.sqrt(np.square(jacobian).sum(axis=0))
    assert np.abs(slope / size).max() < 0.1, "no way down is left, the belief counted"


@given(st.text(min_size=1).filter(lambda s: not re.search(r"@\d+$", s)), st.integers(0, 999), st.integers(0, 9))
def test_a_piece_belongs_to_its_trial_whatever_that_is_called(name: str, number: int, smaller: int) -> None:
    assert recorded_id(name) == name
    assert recorded_id(piece_id(name, number)) == name
    assert recorded_id(piece_id(piece_id(name, number), smaller)) == name
