"""Residuals that are not white count as fewer samples."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.diagnosis.data import Block, TrialData
from spacerobot.diagnosis.models.noise import correlation_time, floor_of, reweighted


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
