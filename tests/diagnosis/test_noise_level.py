"""The noise's level is what is left over its degrees of freedom: samples masked and samples fitted do not count."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.colour import _levels, _Series

SAMPLES = 400


def series(rng: np.random.Generator, sigma: float, taken: int, masked: int, channel: str = "target.x") -> _Series:
    """White noise of which a fit has taken out so many directions."""
    seen = np.ones(SAMPLES)
    seen[:masked] = 0.0
    basis, _ = np.linalg.qr(seen[:, None] * rng.standard_normal((SAMPLES, max(taken, 1))))
    basis = basis[:, :taken]
    noise = sigma * rng.standard_normal(SAMPLES) * seen
    left = (noise - basis @ (basis.T @ noise)) * seen
    return _Series("mocap", channel, left, np.zeros((1, SAMPLES)), basis.T)


@pytest.mark.parametrize(
    ("taken", "masked"), [(0, 0), pytest.param(100, 0, marks=pytest.mark.slow), (0, 150), (100, 150)]
)
def test_the_level_is_unbiased_whatever_was_fitted_or_masked(taken: int, masked: int) -> None:
    rng = np.random.default_rng(7)
    found = [_levels([series(rng, 2.0, taken, masked) for _ in range(4)])["target.x"] for _ in range(60)]
    assert np.mean(found) == pytest.approx(4.0, rel=0.03)


def test_channels_have_their_own_and_none_is_below_what_is_stated() -> None:
    rng = np.random.default_rng(8)
    own = [series(rng, 3.0, 5, 0), series(rng, 0.3, 5, 0, "wrist.x")]
    levels = _levels(own)
    assert levels["target.x"] == pytest.approx(9.0, rel=0.25)
    assert levels["wrist.x"] == 1.0
