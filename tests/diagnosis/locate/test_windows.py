from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from spacerobot.diagnosis.locate.phases import CLEAR, Touches, phases_of, touches_in_force, windows_of
from spacerobot.diagnosis.locate.samples import Grid, interpolation, trapezoid
from spacerobot.diagnosis.locate.windows import Plateau, Splines, Windows

WINDOWS = Windows((Splines(0.1, 1.0, 25), Plateau(1.1, 1.3, 1.5, 1.9)))


def test_derivatives_are_those_of_the_test_functions() -> None:
    t = np.linspace(0.0, 2.0, 8001)
    value, slope, bend = (WINDOWS.values(t, k).toarray() for k in range(3))
    assert np.abs(np.gradient(value, t, axis=1) - slope).max() < 1e-3 * np.abs(slope).max()
    # the second derivative has kinks at the knots, where a difference straddles them
    assert np.abs(np.gradient(slope, t, axis=1) - bend).max() < 1e-2 * np.abs(bend).max()


def test_compact() -> None:
    t = np.array([0.0, 0.0999, 1.0001, 1.0999, 1.9001, 2.5])
    for order in range(3):
        outside = WINDOWS.values(t, order).toarray()
        assert np.abs(outside[:-1]).max() == 0.0
        assert np.abs(outside[-1]).max() == 0.0


@pytest.mark.parametrize("q", [Polynomial([1.0, -2.0, 3.0, 0.5]), Polynomial([0.0, 0.0, 0.0, 0.0, 1.0])])
def test_integration_by_parts(q: Polynomial) -> None:
    t, w = WINDOWS.nodes()
    twice = WINDOWS.values(t, 2) @ (w * q(t))
    once = -(WINDOWS.values(t, 1) @ (w * q.deriv()(t)))
    plain = WINDOWS.values(t, 0) @ (w * q.deriv(2)(t))
    assert np.allclose(twice, plain, atol=1e-10)
    assert np.allclose(once, plain, atol=1e-10)


def test_a_line_has_no_acceleration_even_from_few_samples() -> None:
    time = np.sort(np.random.default_rng(3).uniform(0.0, 2.0, 240))
    grid = Grid.of(WINDOWS, time, 1.0 / 60.0)
    assert np.abs(grid.weights(2) @ (3.0 - 0.7 * time)).max() < 1e-8
    assert np.allclose(grid.weights(1) @ (3.0 - 0.7 * time), 0.7 * (grid.weights(0) @ np.ones(time.size)), atol=1e-10)


def test_interpolation_is_exact_for_its_degree_and_not_beyond() -> None:
    time = np.linspace(0.0, 1.0, 13)
    at = np.linspace(0.0, 1.0, 101)
    matrix = interpolation(time, at)
    assert np.allclose(matrix @ time**5, at**5, atol=1e-12)
    assert np.abs(matrix @ time**8 - at**8).max() > 1e-6


def test_dense_samples_are_summed_as_they_are() -> None:
    time = np.linspace(0.0, 2.0, 4001)
    grid = Grid.of(WINDOWS, time, 0.036)
    assert grid.nodes is time
    # the kinks of second derivatives are not forgiven by a plain sum
    bent = Grid.of(WINDOWS, time, 0.036, bent=True)
    assert np.abs(bent.weights(2) @ (1.0 + time)).max() < 1e-9
    assert np.abs(grid.weights(2) @ (1.0 + time)).max() > 1e-6
    used = np.abs(bent.weights(0)).sum(axis=0)[(time > 0.2) & (time < 0.9)]
    assert used.min() > 0.2 * used.max()  # and no sample is left out
    assert np.isclose(trapezoid(time).sum(), 2.0)


def test_too_short_for_a_test_function() -> None:
    assert Splines.fitting(0.0, 0.1, 0.03) is None
    assert Splines.fitting(0.0, 0.12, 0.03) is not None


def test_touches_stand_clear_of_the_noise() -> None:
    rng = np.random.default_rng(0)
    time = np.arange(0.0, 2.0, 1e-3)
    force = 0.25 * rng.normal(size=time.size)
    sigma = np.full(time.size, 0.25)
    assert touches_in_force(time, force, sigma).stretches == ()
    force[(time > 0.5) & (time < 0.52)] += 5.0
    force[(time > 0.6) & (time < 0.9)] += 5.0
    found = touches_in_force(time, force, sigma)
    assert len(found.stretches) == 2
    assert found.first == pytest.approx(0.5, abs=3e-3)
    assert found.last == pytest.approx(0.9, abs=4e-3)


def test_phases_in_order_and_nothing_bends_across_a_touch() -> None:
    touches = Touches(((0.8, 0.81), (0.84, 1.3)))
    phases = phases_of(touches, 1.1, 0.0, 2.5)
    edges = [t for pair in phases.values() for t in pair]
    assert edges == sorted(edges)
    assert list(phases) == ["approach", "onset", "compression", "reversal", "restitution", "release", "coast"]
    assert phases["onset"] == (0.8, pytest.approx(0.85))
    windows = windows_of(touches, phases, 1.0 / 60.0)
    assert windows is not None
    near = np.array([touches.first - 0.9 * CLEAR, touches.first, touches.last, touches.last + 0.9 * CLEAR])
    assert np.abs(windows.values(near, 2).toarray()).max() == pytest.approx(0.0, abs=1e-9)
    assert windows.values(near, 0).toarray().max() == pytest.approx(1.0)  # but momentum is counted across


def test_no_contact_is_one_phase() -> None:
    phases = phases_of(Touches(()), None, 0.0, 3.0)
    assert phases == {"motion": (0.0, 3.0)}
    windows = windows_of(Touches(()), phases, 0.1)
    assert windows is not None
    assert windows.count == 27
