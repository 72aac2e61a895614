"""A score of noise is noise: mean 0, variance 1, as often beyond a quantile as its p-value says."""

from __future__ import annotations

import math

import numpy as np
import pytest

from spacerobot.diagnosis.locate.scores import STRETCH, Score
from spacerobot.diagnosis.locate.whitening import Whitener, with_directions

COUNT = 1500


def scored(rng: np.random.Generator, noise_known: bool, variants: int, size: float) -> tuple[float, float]:
    """Score and p-value of a pattern against two trials of noise of that size."""
    score = Score(np.arange(float(variants)))
    for rows in (20 * STRETCH, 12 * STRETCH):
        patterns = rng.normal(size=(rows, variants))
        score.add(size * rng.normal(size=rows), patterns, patterns)
    found = score.verdict(0.0, noise_known)
    assert found is not None
    return found.score, math.exp(found.log_p)


@pytest.mark.parametrize(("noise_known", "size"), [(True, 1.0), (False, 1.0), (False, 30.0)])
def test_one_pattern_against_noise(noise_known: bool, size: float) -> None:
    rng = np.random.default_rng(1)
    found = np.array([scored(rng, noise_known, 1, size) for _ in range(COUNT)])
    units = 32
    variance = 1.0 if noise_known else (units - 1.0) / (units - 3.0)  # of Student's t
    assert abs(found[:, 0].mean()) < 4.0 / math.sqrt(COUNT)
    assert found[:, 0].var() == pytest.approx(variance, abs=4.0 * variance * math.sqrt(2.0 / COUNT))
    for level in (0.05, 0.5):
        assert np.mean(found[:, 1] <= level) == pytest.approx(level, abs=4.0 * math.sqrt(level * (1 - level) / COUNT))


def test_the_best_of_several_is_not_taken_for_one() -> None:
    rng = np.random.default_rng(2)
    p = np.array([scored(rng, True, 6, 1.0)[1] for _ in range(COUNT)])
    for level in (0.05, 0.5):
        assert np.mean(p <= level) == pytest.approx(level, abs=4.0 * math.sqrt(level * (1 - level) / COUNT))


def test_a_planted_pattern_is_measured_with_its_error() -> None:
    rng = np.random.default_rng(3)
    pulls = []
    for known in (True, False):
        for _ in range(300):
            score = Score(np.zeros(1))
            for rows in (160, 96):
                pattern = rng.normal(size=(rows, 1))
                score.add(0.7 * pattern[:, 0] + rng.normal(size=rows), pattern, pattern)
            found = score.verdict(0.0, known)
            assert found is not None
            pulls.append((found.coefficient - 0.7) / found.error)
            assert found.fall == pytest.approx(found.coefficient**2 * float(score.information[0]))  # type: ignore[index]
    assert np.var(pulls) == pytest.approx(1.0, abs=0.25)
    assert abs(np.mean(pulls)) < 0.17


def test_whitened_noise_is_white_with_beliefs_and_without() -> None:
    rng = np.random.default_rng(4)
    factor = rng.normal(size=(12, 12))
    sensor = factor @ factor.T + np.diag(np.geomspace(1e-6, 1.0, 12))
    beliefs = {"one": rng.normal(size=12) * 3.0, "two": rng.normal(size=12)}
    whole = with_directions(sensor, beliefs)
    raw = np.linalg.cholesky(sensor) @ rng.normal(size=(12, 20_000))
    for direction in beliefs.values():
        raw = raw + direction[:, None] * rng.normal(size=20_000)
    np.testing.assert_allclose(np.cov(Whitener(whole)(raw)), np.eye(12), atol=0.05)
    assert np.abs(np.cov(Whitener(sensor)(raw)) - np.eye(12)).max() > 1.0


@pytest.mark.parametrize("units", [6, 8, 25])
def test_a_constant_pattern_is_a_mean_with_the_standard_error_of_the_textbook(units: int) -> None:
    """Of the stretches' own means, with one degree of freedom lost; p by Student's t."""
    from scipy.stats import ttest_1samp

    rng = np.random.default_rng(units)
    white = 0.3 + rng.normal(size=units * STRETCH)
    ones = np.ones((white.size, 1))
    score = Score(np.zeros(1))
    score.add(white, ones, ones)
    found = score.verdict(0.0, False)
    assert found is not None
    means = white.reshape(units, STRETCH).mean(axis=1)
    textbook = ttest_1samp(means, 0.0)
    assert found.coefficient == pytest.approx(means.mean())
    assert found.error == pytest.approx(means.std(ddof=1) / math.sqrt(units))
    assert found.score == pytest.approx(float(textbook.statistic))
    assert math.exp(found.log_p) == pytest.approx(float(textbook.pvalue))
