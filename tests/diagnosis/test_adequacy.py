"""What a fit leaves over is called noise when it is noise, and not when it is not."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.adequacy import ChannelLeft, left_over
from spacerobot.diagnosis.terms.data import Block, TrialData

TRIALS, SAMPLES, TOUCH = 6, 600, 0.5


def made(
    shape: Any = None, scale: float = 1.0, colour: float = 0.0, only: int | None = None, seed: int = 3
) -> tuple[Any, list[TrialData]]:
    """Noise residuals of one channel, plus `shape(t)` after touch in every trial, or in one."""
    random = np.random.default_rng(seed)
    time = np.linspace(0.0, 2.0, SAMPLES)
    trials, residuals = [], {}
    for k in range(TRIALS):
        noise = scale * random.standard_normal(SAMPLES)
        for i in range(1, SAMPLES):
            noise[i] += colour * noise[i - 1]
        if shape is not None and only in (None, k):
            noise = noise + np.where(time > TOUCH, shape(time), 0.0)
        ones = np.ones((1, SAMPLES))
        block = Block("mocap", ("target.x",), time, 0.0 * ones, ones)
        trials.append(TrialData(str(k), "all", {}, (block,), 0.0, 2.0))
        residuals[str(k)] = SimpleNamespace(residual=noise)
    return SimpleNamespace(trials=residuals), trials


def leaves(**how: Any) -> Any:
    fit, trials = made(**how)
    return left_over(fit, trials, {t.id: TOUCH for t in trials})


def test_white_noise_is_adequate() -> None:
    left = leaves()
    assert left.adequate
    assert left.inflation == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("how", [{"scale": 1.5}, {"colour": 0.3}])
def test_understated_or_coloured_sensor_noise_is_not_physics(how: dict[str, float]) -> None:
    left = leaves(**how)
    assert left.adequate
    assert left.inflation > 1.3


def test_noise_that_goes_on_and_on_is_less_sure_of_its_own_level() -> None:
    """Smoothed tracks: each trial's level scatters twice as far as that of white noise, and none of it is physics."""
    smoothed = {"colour": 0.85, "scale": float(np.sqrt(1.0 - 0.85**2))}
    assert sum(leaves(**smoothed, seed=seed).adequate for seed in range(20)) >= 19
    assert not leaves(**smoothed, shape=lambda t: 3.0 * np.sin(6.0 * t)).adequate


def test_a_smooth_force_left_out_is_seen() -> None:
    assert not leaves(shape=lambda t: 0.8 * np.sin(6.0 * t)).adequate


def test_an_effect_in_one_trial_of_six_is_seen() -> None:
    left = leaves(shape=lambda t: 1.5 * np.sin(6.0 * t), only=4)
    assert not left.adequate
    assert left.channels[0].worst_trial == "4"


def test_physics_that_acts_in_the_approach_is_not_taken_for_noise() -> None:
    """A drag left out bends the approach; were that the noise, what it leaves later would pass for noise too."""
    fit, trials = made()
    time = trials[0].blocks[0].time
    early = time < TOUCH
    for trial in fit.trials.values():
        trial.residual[early] += 2.0 * ((time[early] / TOUCH * 2.0 - 1.0) ** 2 - 1.0 / 3.0)
    left = left_over(fit, trials, {t.id: TOUCH for t in trials})
    assert left.channels[0].bent
    assert left.channels[0].noise == pytest.approx(1.0, abs=0.15)
    assert not left.adequate


def test_a_level_is_compared_with_what_few_samples_before_contact_can_say() -> None:
    """Noise known from ten samples is known to 45 per cent; from a million, to the last digit."""
    left = ChannelLeft("x", 1.0, 1.9, 100_000, 0.0, 0.0, 0.0, 0.0, "a")
    assert not left.white
    assert replace(left, early=10).white
    assert not replace(left, early=10, level=3.5).white
