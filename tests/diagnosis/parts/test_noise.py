"""Residuals that are not white count as fewer samples."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.fitting.noise import correlation_time, floor_of, reweighted, squares_of
from spacerobot.diagnosis.terms.data import Block, TrialData


def autoregressive(rho: float, count: int, seed: int) -> np.ndarray:
    white = np.random.default_rng(seed).standard_normal(count)
    out = np.empty(count)
    out[0] = white[0]
    for i in range(1, count):
        out[i] = rho * out[i - 1] + np.sqrt(1 - rho**2) * white[i]
    return out


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9])
def test_correlation_time_of_a_known_process(rho: float) -> None:
    found = np.mean([correlation_time(autoregressive(rho, 20_000, s)) for s in range(5)])
    assert found == pytest.approx((1 + rho) / (1 - rho), rel=0.12)


def test_a_constant_is_one_sample() -> None:
    assert correlation_time(np.ones(500)) > 400
    assert correlation_time(np.zeros(5)) == 1.0


def trial(residual: np.ndarray, weight: float) -> TrialData:
    n = residual.size
    block = Block("s", ("a", "b"), np.arange(n) * 1.0, np.zeros((2, n)), np.full((2, n), weight))
    return TrialData("t", "c", {}, (block,), 0.0, float(n))


def test_weights_from_the_residual_make_chi_squared_count_independent_samples() -> None:
    n, rho = 20_000, 0.9
    slow, white = 0.3 * autoregressive(rho, n, 1), 5.0 * np.random.default_rng(2).standard_normal(n)
    one = trial(slow, 2.0)
    weighted = np.concatenate([2.0 * slow, 2.0 * white])
    factor = floor_of({"t": weighted}, [one])
    (new,) = reweighted([one], factor)
    ratio = new.blocks[0].weight[:, 0] / 2.0
    chi2 = [(r**2).sum() for r in (2.0 * slow * ratio[0], 2.0 * white * ratio[1])]
    assert chi2[0] == pytest.approx(n * (1 - rho) / (1 + rho), rel=0.2)
    assert chi2[1] == pytest.approx(n, rel=0.05)


@given(st.integers(3, 40), st.integers(0, 2**20))
def test_a_series_does_not_follow_on_itself(count: int, seed: int) -> None:
    """The correlation by its sum over pairs of readings: none of the last with the first."""
    series = autoregressive(0.6, count, seed) + 0.3
    lagged = [float(series[k:] @ series[: count - k]) for k in range(count)]
    end = next((k for k, x in enumerate(lagged) if x <= 0.0), count)
    direct = min(max(1.0 + 2.0 * sum(lagged[1:end]) / lagged[0], 1.0), count)
    assert correlation_time(series) == pytest.approx(direct, rel=1e-9)


@given(st.floats(1e-3, 1e3), st.integers(0, 2**20))
def test_squares_are_those_of_the_readings_whatever_they_weigh(by: float, seed: int) -> None:
    values = np.random.default_rng(seed).standard_normal(20)
    one = trial(values, by)
    found = squares_of({"t": np.tile(by * values, 2)}, [one])
    assert found["a"] == (pytest.approx(float(values @ values)), 20)


def test_a_trial_of_few_readings_says_little_of_how_long_noise_lasts() -> None:
    slow = autoregressive(0.9, 4000, 3)
    long, short = trial(slow, 1.0), trial(slow[:4], 1.0)
    short = TrialData("few", "c", {}, short.blocks, 0.0, 4.0)
    rows = {"t": np.tile(slow, 2), "few": np.tile([0.9, -0.8, 0.7, -0.9], 2)}
    alone, both = floor_of(rows, [long])["a"], floor_of(rows, [long, short])["a"]
    assert both == pytest.approx(alone, rel=0.01)
