from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import chi2, norm

from spacerobot.diagnosis.locate.significance import combined, flip_p, holm, log_p_chi2, log_p_normal, sign_flips


def test_holm_by_hand() -> None:
    p = [0.01, 0.04, 0.03, 0.005]
    assert holm([math.log(x) for x in p]) == pytest.approx([0.03, 0.06, 0.06, 0.02])


def test_holm_never_exceeds_one_nor_reverses_the_order() -> None:
    p = np.sort(np.random.default_rng(0).uniform(size=50))
    corrected = holm(np.log(p).tolist())
    assert corrected == sorted(corrected)
    assert max(corrected) <= 1.0
    assert all(c >= x for c, x in zip(corrected, p, strict=True))


def test_tails() -> None:
    assert log_p_normal(1.96) == pytest.approx(math.log(2.0 * norm.sf(1.96)))
    assert log_p_normal(60.0) == pytest.approx(-1800.0, rel=0.01)  # far beyond the smallest float
    assert log_p_chi2(30.0, 10) == pytest.approx(math.log(chi2.sf(30.0, 10)))
    assert log_p_chi2(1e5, 10) == pytest.approx(-5e4, rel=0.01)


def test_best_of_many() -> None:
    assert math.exp(combined(math.log(0.01), 10)) == pytest.approx(1.0 - 0.99**10)
    assert combined(-100.0, 10) == pytest.approx(-100.0 + math.log(10.0))


def test_flips_are_exact_for_few_units() -> None:
    assert sign_flips(4).shape == (8, 4)
    assert flip_p(np.ones(6)) == pytest.approx(1.0 / 32.0)
    assert flip_p(np.array([5.0, 0.0, 0.0])) == 1.0  # one stretch alone can always flip


def test_flips_are_uniform_on_noise() -> None:
    rng = np.random.default_rng(2)
    p = np.array([flip_p(rng.normal(size=10)) for _ in range(400)])
    assert np.mean(p <= 0.05) < 0.08
    assert 0.4 < np.mean(p <= 0.5) < 0.6
