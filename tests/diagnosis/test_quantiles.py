"""Where chance ends: quantiles of chi-squared at their edges, and tails beyond the smallest number a float can hold."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import gammaln

from spacerobot.diagnosis.fitting.profile import LEVEL_95
from spacerobot.diagnosis.locate.significance import log_p_chi2, log_p_normal, log_p_student
from spacerobot.diagnosis.selection.nested_laws import by_chance
from spacerobot.diagnosis.terms.decision import CHANCE


@pytest.mark.parametrize(("parameters", "edge"), [(1, 3.841), (2, 5.991), (3, 7.815), (4, 9.488)])
def test_what_chance_brings_ends_at_the_tabulated_quantile(parameters: int, edge: float) -> None:
    """Abramowitz and Stegun, Table 26.8, 5 %."""
    assert CHANCE == 0.05
    assert by_chance(edge - 1e-3, parameters)
    assert not by_chance(edge + 1e-3, parameters)


def test_an_interval_of_95_per_cent_ends_there_too() -> None:
    assert pytest.approx(3.8415, abs=1e-4) == LEVEL_95
    assert math.sqrt(LEVEL_95) == pytest.approx(1.95996, abs=1e-5)


def test_chance_gains_what_it_is_said_to() -> None:
    """Further parameters that mean nothing, fitted to noise: the gain passes in 95 of 100."""
    rng = np.random.default_rng(3)
    for parameters in (1, 2, 3):
        basis, _ = np.linalg.qr(rng.normal(size=(50, parameters)))
        gains = np.square(rng.normal(size=(20_000, 50)) @ basis).sum(axis=1)
        assert np.mean([by_chance(g, parameters) for g in gains]) == pytest.approx(0.95, abs=0.006)


def test_the_best_of_many_looks_is_held_to_the_tail_of_the_best() -> None:
    """The largest gain of twenty directions that mean nothing passes in 95 of 100; priced as one look, hardly ever."""
    rng = np.random.default_rng(4)
    best = np.square(rng.normal(size=(20_000, 20))).max(axis=1)
    assert np.mean([by_chance(g, 1, 20) for g in best]) == pytest.approx(0.95, abs=0.006)
    assert np.mean([by_chance(g, 1) for g in best]) < 0.5


def student_tail(t: float, freedom: int) -> float:
    """log of P(|T| > t) from the density, by the substitution x = t e^u, its peak taken out."""

    def log_density(x: float) -> float:
        constant = gammaln(0.5 * (freedom + 1)) - gammaln(0.5 * freedom) - 0.5 * math.log(freedom * math.pi)
        return float(constant - 0.5 * (freedom + 1) * math.log1p(x * x / freedom))

    peak = log_density(t) + math.log(t)
    found, _ = quad(lambda u: math.exp(log_density(t * math.exp(u)) + math.log(t) + u - peak), 0.0, 60.0, limit=200)
    return math.log(2.0 * found) + peak


@pytest.mark.parametrize("freedom", [1, 2, 5, 30, 200])
@pytest.mark.parametrize("t", [0.7, 3.0, 40.0, 1e3, 1e6, 1e60])
def test_the_tail_of_student_goes_on_where_floats_end(freedom: int, t: float) -> None:
    assert log_p_student(t, freedom) == pytest.approx(student_tail(t, freedom), rel=1e-6, abs=1e-9)
    assert log_p_student(-t, freedom) == log_p_student(t, freedom)


def test_student_is_normal_with_many_degrees_and_wider_with_few() -> None:
    assert log_p_student(2.0, 10**7) == pytest.approx(log_p_normal(2.0), rel=1e-5)
    assert log_p_student(2.0, 3) > log_p_student(2.0, 30) > log_p_normal(2.0)


@pytest.mark.parametrize("freedom", [1, 2, 7, 400])
def test_tails_fall_without_a_step(freedom: int) -> None:
    """Where one formula hands over to another nothing jumps, and a larger score is never more likely."""
    for tail in (lambda x: log_p_student(x, freedom), lambda x: log_p_chi2(x, freedom), log_p_normal):
        at = np.geomspace(1.0, 1e8, 4001)
        found = np.array([tail(float(x)) for x in at])
        assert np.isfinite(found).all()
        assert (np.diff(found) <= 0.0).all()
        bend = np.diff(found, 2) / (1.0 + np.abs(found[1:-1]))
        assert np.abs(bend).max() < 0.02


@pytest.mark.parametrize(("x", "freedom"), [(4e3, 1), (1e5, 2), (1e5, 10), (3e4, 200)])
def test_the_tail_of_chi_squared_goes_on_too(x: float, freedom: int) -> None:
    """Q(a, z) = z^(a-1) e^-z / Gamma(a) (1 + (a-1)/z + ...), Abramowitz and Stegun 6.5.32."""
    a, z = 0.5 * freedom, 0.5 * x
    series, term = 1.0, 1.0
    for k in range(1, 60):
        term *= (a - k) / z
        series += term
    assert log_p_chi2(x, freedom) == pytest.approx((a - 1) * math.log(z) - z - gammaln(a) + math.log(series), rel=1e-6)
