"""A free approach that is bent is told from one that is noisy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from spacerobot.diagnosis.fitting.approach import approach

TRIALS, SAMPLES = 9, 70


def noise(seed: int, colour: float = 0.0, share: float = 0.0) -> list[np.ndarray]:
    """White noise of unit variance, a share of it coloured."""
    random = np.random.default_rng(seed)
    white = random.standard_normal((TRIALS, SAMPLES)) * np.sqrt(1.0 - share)
    driven = random.standard_normal((TRIALS, SAMPLES + 200)) * np.sqrt(share * (1.0 - colour**2))
    return list(white + lfilter([1.0], [1.0, -colour], driven, axis=1)[:, 200:])


def bend(parts: list[np.ndarray], size: float, signs: np.ndarray) -> list[np.ndarray]:
    """The same with a drag's bend in each."""
    t = np.linspace(-1.0, 1.0, SAMPLES)
    return [p + size * s * (t**2 - 1.0 / 3.0) for p, s in zip(parts, signs, strict=True)]


@pytest.mark.parametrize("seed", range(20))
def test_noise_is_not_bent(seed: int) -> None:
    found = approach(noise(seed), 1.0)
    assert not found.bent
    assert found.count == TRIALS * SAMPLES
    assert found.level == pytest.approx(1.0, abs=0.25)


@pytest.mark.parametrize("seed", range(20))
def test_coloured_noise_as_cameras_have_it_is_not_bent(seed: int) -> None:
    assert not approach(noise(seed, colour=0.85, share=0.05), 1.0).bent


@pytest.mark.parametrize("later", [1.0, 3.0])
def test_a_bend_that_all_trials_share_is_no_noise(later: float) -> None:
    sizes = np.linspace(0.6, 1.4, TRIALS)  # a drag bends fast trials more
    found = approach(bend(noise(1), 2.5, sizes), later)
    assert found.bent
    assert found.level == pytest.approx(1.0, abs=0.2)  # the noise is known all the same
    assert found.count == TRIALS * (SAMPLES - 3)


def test_the_side_of_the_bend_does_not_matter() -> None:
    assert approach(bend(noise(1), -2.5, np.ones(TRIALS)), 3.0).bent


def test_noise_that_wanders_on_after_the_touch_is_noise() -> None:
    """Here one way, there another: only a quiet time after the touch shows that it was none."""
    signs = np.array([1.0, -1.0] * TRIALS)[:TRIALS]
    parts = bend(noise(2), 2.5, signs)
    wandering = approach(parts, float(np.var(np.concatenate(parts))))
    assert not wandering.bent
    assert wandering.level > 1.3
    assert approach(parts, 1.0).bent


def test_too_few_or_too_short_approaches_say_nothing() -> None:
    bent = bend(noise(1), 5.0, np.ones(TRIALS))
    assert not approach(bent[:3], 1.0).bent
    assert not approach([p[:10] for p in bent], 1.0).bent
    assert approach([], 1.0).count == 0
