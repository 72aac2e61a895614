"""Filters of sensors: a contact's jumps are taken when they happen, wherever the grid's points lie."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import spacerobot.simulation.sensors as sensors
from spacerobot.effects.registry import effect
from spacerobot.simulation.reduced.run import ReducedRun, simulate
from spacerobot.simulation.rig import rig

PLAIN = {
    "wrist.mass": 0.7,
    "wrist.stiffness": 1020.0,
    "wrist.damping": 2.1,
    "contact.stiffness": 6.8e4,
    "contact.damping": 60.0,
    "target.mass": 9.0,
}
TIMES = np.arange(0.0, 0.35, 1e-3)
STEP = 2e-6
"""Of the reference's quadrature [s]."""


def pushed(cutoff: float, gap: float) -> tuple[ReducedRun, np.ndarray]:
    """A target that comes from so far away, and the force as a filtered sensor shows it."""
    mechanism = effect("low_pass").apply(rig(PLAIN), "force_sensor", {"cutoff_Hz": cutoff})
    run = simulate(mechanism, position={"target": -gap}, velocity={"target": 0.1}, end=0.36, tolerance=1e-9)
    return run, sensors.read_channels(run, mechanism, ("contact.force",), TIMES)["contact.force"]


def by_quadrature(run: ReducedRun, cutoff: float) -> np.ndarray:
    """The filter's convolution summed by the midpoints of very short steps."""
    middle = np.arange(0.5 * STEP, TIMES[-1], STEP)
    rate = 2.0 * np.pi * cutoff
    grown = np.cumsum(run.contact_at(middle) * np.exp(rate * (middle - TIMES[-1]))) * rate * STEP
    so_far = np.interp(TIMES, np.append(0.0, middle + 0.5 * STEP), np.append(0.0, grown))
    return so_far * np.exp(-rate * (TIMES - TIMES[-1]))


def error(run: ReducedRun, seen: np.ndarray, cutoff: float) -> float:
    """Largest difference over the largest force, but for the one reading between whose points a touch falls."""
    beside = np.abs(TIMES[:, None] - run.switches()[None, :]).min(axis=1) < 2e-4
    wrong = np.abs(seen - by_quadrature(run, cutoff))[~beside]
    return float(wrong.max() / np.abs(seen).max())


@settings(max_examples=12, deadline=None)
@given(st.floats(30.0, 90.0), st.floats(0.0100, 0.0101))
def test_a_filtered_force_is_the_convolution(cutoff: float, gap: float) -> None:
    run, seen = pushed(cutoff, gap)
    assert run.touches().size > 0
    assert error(run, seen, cutoff) < 1e-3


def test_jumps_that_are_moved_to_the_grid_are_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sensors, "_jumps", lambda *args: (np.empty(0), np.empty(0)))
    worst = max(error(*pushed(90.0, gap), 90.0) for gap in (0.0100, 0.010003, 0.010006))
    assert worst > 3e-3


def test_a_reading_moves_smoothly_with_the_touch() -> None:
    """A fit steps from touch to touch: nothing may happen where one crosses a point of the grid."""
    gaps = 0.01 + np.arange(21) * 2e-6  # over four of the grid's steps
    steps = np.abs(np.diff([pushed(90.0, gap)[1][110:150] for gap in gaps], axis=0)).max(axis=1)
    assert steps.max() < 2.0 * np.median(steps)
