"""Corners in what a model leaves over: found where they are, not found where something smooth is missing."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.diagnosis.locate.kinks import Track, kinks

TIME = np.linspace(0.0, 30.0, 300)


def tracks(*bends: np.ndarray, noise: float = 1e-3, seed: int = 3) -> list[Track]:
    """Tracks with these residuals and noise."""
    random = np.random.default_rng(seed)
    return [Track(TIME, (bend + noise * random.standard_normal(TIME.size)) / noise) for bend in bends]


@pytest.mark.parametrize("moments", [(11.3,), (6.0, 21.7)])
def test_corners_are_found_where_they_are(moments: tuple[float, ...]) -> None:
    """Each interval holds its moment, or nearly; two tracks that are bent at the same time are one knock."""
    steps = [(-1) ** k * 3e-3 for k in range(len(moments))]
    bend = sum(s * np.maximum(TIME - m, 0.0) for s, m in zip(steps, moments, strict=True))
    found = kinks(tracks(np.asarray(bend), -0.5 * np.asarray(bend)))
    assert [m.time for m in found] == pytest.approx(moments, abs=0.3)
    assert all(m.low < m.time < m.high for m in found)


@pytest.mark.parametrize(
    "bend",
    [1e-5 * TIME**2, 4e-3 * np.sin(0.3 * TIME), 1e-6 * (TIME - 12.0) ** 3, np.zeros_like(TIME)],
    ids=["tilt", "wave", "cubic", "noise"],
)
def test_what_is_smooth_has_no_corner(bend: np.ndarray) -> None:
    """A force that lasts is no knock, however much of it is left over."""
    assert kinks(tracks(bend, 0.3 * bend)) == ()


@pytest.mark.parametrize("lasts", [2.0, 3.0, 5.0])
def test_a_push_that_lasts_is_found_with_its_length(lasts: float) -> None:
    """A steady force from 11 s on: what is cut out holds all of it, and nothing of it is left in the stretches."""
    push = 3e-3 / (2.0 * lasts) * (np.maximum(TIME - 11.0, 0.0) ** 2 - np.maximum(TIME - 11.0 - lasts, 0.0) ** 2)
    (found,) = kinks(tracks(push, -0.5 * push, noise=1e-4))
    assert found.time == pytest.approx(11.0 + 0.5 * lasts, abs=0.2)
    assert found.lasts[0] == pytest.approx(lasts, rel=0.3)
    assert found.low < 11.1
    assert found.high > 10.9 + lasts


def test_a_step_of_a_rate_is_a_corner() -> None:
    """Where velocities were recorded."""
    random = np.random.default_rng(5)
    rest = 5.0 * (TIME > 17.2) + random.standard_normal(TIME.size)
    (found,) = kinks([Track(TIME, rest, rate=True)])
    assert found.time == pytest.approx(17.2, abs=0.3)


@pytest.mark.parametrize("size", [10.0, 30.0])
def test_a_tracker_that_jumps_is_no_knock(size: float) -> None:
    """Whatever its noise: the position steps while the body goes on as before, and no impulse can do that."""
    for seed in range(4):
        random = np.random.default_rng(seed)
        for noise in (random.standard_normal(TIME.size), random.standard_t(3, TIME.size) / np.sqrt(3.0)):
            assert kinks([Track(TIME, size * (TIME > 12.9) + noise)]) == (), seed


def test_a_knock_is_found_beside_a_tracker_that_jumps() -> None:
    """The jump takes nothing from it."""
    random = np.random.default_rng(8)
    rest = 3.0 * np.maximum(TIME - 20.1, 0.0) + 15.0 * (TIME > 7.7) + random.standard_normal(TIME.size)
    (found,) = kinks([Track(TIME, rest)])
    assert found.time == pytest.approx(20.1, abs=0.4)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_quiet_track_is_heard_beside_a_loud_one(seed: int) -> None:
    """Noise is every track's own: what was left out of one hides no knock that another one shows."""
    random = np.random.default_rng(seed)
    corner, wave = 1e-3 * np.maximum(TIME - 9.4, 0.0), 0.01 * np.sin(0.3 * TIME + 1.0)
    quiet = Track(TIME, corner + 2e-4 * random.standard_normal(TIME.size))
    loud = Track(TIME, wave + 1e-3 * random.standard_normal(TIME.size))
    (found,) = kinks([quiet, loud])
    assert found.time == pytest.approx(9.4, abs=0.3)
    assert kinks([Track(TIME, quiet.rest - corner), loud]) == ()
