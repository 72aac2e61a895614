"""A trial under another target's label shows by its momentum alone; nothing that all trials share makes one odd."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.diagnosis.fitting.labels import MASS, mislabelled, rightly_labelled
from spacerobot.diagnosis.terms.data import Block, TrialData

MASSES = (6.0, 9.0, 14.0)


def trial(number: int, mass: float, stated: float, rng: np.random.Generator, scale: float = 1.0) -> TrialData:
    """A target that comes at its own speed and is pushed back by half a sine of force."""
    speed = float(rng.uniform(0.04, 0.12))
    impulse, length = 1.6 * mass * speed, 0.2
    fast, slow = np.arange(0.0, 2.0, 1e-3), np.arange(0.0, 2.0, 5e-3)
    inside = (fast > 1.0) & (fast < 1.0 + length)
    force = np.where(inside, impulse * np.pi / (2.0 * length) * np.sin(np.pi * (fast - 1.0) / length), 0.0)
    gone = np.clip((slow - 1.0) / length, 0.0, 1.0)
    back = length * 0.5 * (gone - np.sin(np.pi * gone) / np.pi) + np.maximum(slow - 1.0 - length, 0.0)
    track = speed * (slow - 1.0) - impulse / mass * back
    blocks = (
        _block("mocap", "target.x", slow, track, 1e-4, rng),
        _block("force", "contact.force", fast, scale * force, 0.02, rng),
    )
    return TrialData(f"{number:02d}", f"{stated:g}", {MASS: stated}, blocks, 0.0, 2.0)


def _block(
    stream: str, name: str, time: np.ndarray, value: np.ndarray, sigma: float, rng: np.random.Generator
) -> Block:
    noisy = value + sigma * rng.standard_normal(value.size)
    return Block(stream, (name,), time, noisy[None, :], np.full((1, time.size), 1.0 / sigma))


def campaign(seed: int, wrong: tuple[int, ...] = (), scale: float = 1.0) -> list[TrialData]:
    rng = np.random.default_rng(seed)
    made = []
    for number in range(12):
        mass = MASSES[number % 3]
        stated = MASSES[(number + 1) % 3] if number in wrong else mass
        made.append(trial(number, mass, stated, rng, scale))
    return made


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000), st.integers(0, 11), st.sampled_from([0.8, 1.0, 1.3]))
def test_one_wrong_label_is_found_whatever_the_force_sensors_scale(seed: int, number: int, scale: float) -> None:
    trials = campaign(seed, (number,), scale)
    (found,) = mislabelled(trials)
    assert found.trial == f"{number:02d}"
    assert found.like == MASSES[number % 3]
    assert found.shown == pytest.approx(found.like, rel=0.03)
    assert len(rightly_labelled(trials)) == 11


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from([0.8, 1.0, 1.3]))
def test_right_labels_stay(seed: int, scale: float) -> None:
    assert mislabelled(campaign(seed, (), scale)) == []


def test_a_mass_that_is_no_other_targets_is_nobodys_label() -> None:
    """A wrong believed mass is the fit's affair."""
    trials = campaign(1)
    trials[4] = trial(4, 1.25 * MASSES[1], MASSES[1], np.random.default_rng(1))
    assert mislabelled(trials) == []


def test_where_half_are_odd_nobody_is() -> None:
    assert mislabelled(campaign(2, (0, 1, 2, 3, 4, 5))) == []


def test_a_clipped_impulse_says_nothing() -> None:
    trials = campaign(3)
    own = trials[4].blocks[1]
    weight = np.where(own.value > 0.5 * own.value.max(), 0.0, own.weight)
    trials[4] = replace(trials[4], blocks=(trials[4].blocks[0], replace(own, weight=weight)))
    assert mislabelled(trials) == []


def test_a_force_sensor_of_twenty_readings_a_second_says_nothing() -> None:
    trials = []
    for one in campaign(3):
        camera, own = one.blocks
        slow = replace(own, time=own.time[::50], value=own.value[:, ::50], weight=own.weight[:, ::50])
        trials.append(replace(one, blocks=(camera, slow)))
    assert mislabelled(trials) == []
