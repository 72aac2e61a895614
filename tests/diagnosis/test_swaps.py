"""Markers taken for each other are found; bodies that meet, pass or are still are not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.fitting.swaps import swapped

SIGMA = 2e-4


def tracks(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A target that comes, pushes a wrist in and leaves, 200 a second."""
    t = np.arange(400) / 200.0
    target = np.where(t < 1.0, 0.08 * (1.0 - t), -0.06 * (t - 1.0))
    wrist = np.where(t < 1.0, 0.0, -0.02 * np.sin(12.0 * (t - 1.0)) * np.exp(-t))
    noise = SIGMA * np.random.default_rng(seed).standard_normal((2, t.size))
    return target + noise[0], wrist + noise[1]


@given(st.integers(0, 200), st.integers(0, 370), st.integers(1, 30))
def test_an_exchange_is_found_where_the_two_are_apart(seed: int, begin: int, count: int) -> None:
    one, other = tracks(seed)
    rows = slice(begin, begin + count)
    clear = np.abs(one - other) > 40.0 * SIGMA
    if not clear[max(begin - 1, 0) : begin + count + 1].all():
        return
    one[rows], other[rows] = other[rows].copy(), one[rows].copy()
    expected = np.zeros(one.size, dtype=bool)
    expected[rows] = True
    assert (swapped(one, other, np.sqrt(2.0) * SIGMA) == expected).all()


@given(st.integers(0, 1000))
def test_a_meeting_is_no_exchange(seed: int) -> None:
    one, other = tracks(seed)
    assert not swapped(one, other, np.sqrt(2.0) * SIGMA).any()


@pytest.mark.parametrize("speed", [0.5, 2.0, 20.0])
def test_bodies_that_pass_once_are_no_exchange_that_ends(speed: float) -> None:
    """A fast pass turns the sign of the distance too, but the middle goes on with it only by chance."""
    t = np.arange(400) / 200.0
    one, other = speed * (t - 1.0013), np.zeros(t.size)
    assert not swapped(one, other, SIGMA).any()
