from __future__ import annotations

import numpy as np

from spacerobot.diagnosis.locate.smoothing import Pieces, Smooth


def test_noise_on_a_line_is_smoothed_to_a_line() -> None:
    rng = np.random.default_rng(5)
    time = np.linspace(0.0, 3.0, 360)
    smooth = Smooth.through(time, 0.2 + 0.1 * time + 1e-3 * rng.normal(size=360), np.full(360, 1e-3))
    at = np.linspace(0.1, 2.9, 50)
    assert np.abs(smooth.value(at) - 0.2 - 0.1 * at).max() < 5e-4
    assert np.abs(smooth.value(at, 1) - 0.1).max() < 2e-3


def test_errors_cover() -> None:
    score, rate = [], []
    time, at = np.linspace(0.0, 3.0, 360), np.linspace(0.2, 2.8, 40)
    for seed in range(20):
        rng = np.random.default_rng(seed)
        smooth = Smooth.through(time, np.sin(6.0 * time) + 0.02 * rng.normal(size=360), np.full(360, 0.02))
        score.append((smooth.value(at) - np.sin(6.0 * at)) / smooth.error(at))
        rate.append((smooth.value(at, 1) - 6.0 * np.cos(6.0 * at)) / smooth.error(at, 1))
    assert 0.6 < np.std(score) < 1.3
    assert 0.5 < np.std(rate) < 1.4


def test_each_stretch_is_as_rough_as_it_must_be() -> None:
    rng = np.random.default_rng(1)
    time = np.linspace(0.0, 2.0, 240)
    value = np.where(time < 1.0, 0.0, np.sin(60.0 * (time - 1.0))) + 0.02 * rng.normal(size=240)
    sigma = np.full(240, 0.02)
    one, two = Smooth.through(time, value, sigma), Pieces.through(time, value, sigma, [1.0])
    rest = np.linspace(0.1, 0.9, 50)
    assert np.std(two.value(rest)) < 0.5 * np.std(one.value(rest))
    assert np.abs(two.value(np.linspace(1.2, 1.8, 50)) - np.sin(60.0 * np.linspace(0.2, 0.8, 50))).max() < 0.1
