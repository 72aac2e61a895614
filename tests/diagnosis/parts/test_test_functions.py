"""Test functions: exact where they must be, consistent with each other, of the promised order."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.diagnosis.machines.test_functions import Bump
from spacerobot.support.errors import InputError


def test_polynomials_are_seen_exactly() -> None:
    bump, t = Bump.of(6, 0.01), 0.01 * np.arange(60)
    inner = t[6:-6]
    np.testing.assert_allclose(bump.smooth(np.full(60, 3.0)), 3.0)
    np.testing.assert_allclose(bump.rate(4.0 * t), 4.0)
    np.testing.assert_allclose(bump.rate(t**2), 2.0 * inner, atol=1e-12)
    np.testing.assert_allclose(bump.acceleration(t**2), 2.0)


@pytest.mark.parametrize("omega", [5.0, 20.0, 40.0])
def test_derivatives_pass_the_same_share_as_the_smoothing(omega: float) -> None:
    """What makes a balance fair: force and acceleration of a sine are weakened alike, however narrow the bump."""
    step = 0.005
    bump, t = Bump.of(5, step), step * np.arange(2000)
    seen, rate, curve = (f(np.sin(omega * t)) for f in (bump.smooth, bump.rate, bump.acceleration))
    scale = (omega * step) ** 4
    assert np.abs(curve + omega**2 * seen).max() < 0.02 * scale * omega**2 * np.abs(seen).max()
    shifted = bump.smooth(omega * np.cos(omega * t))
    assert np.abs(rate - shifted).max() < 0.1 * scale * np.abs(shifted).max()


def test_columns_are_seen_each_by_itself() -> None:
    bump = Bump.of(4, 0.1)
    x = np.random.default_rng(0).standard_normal((50, 3))
    np.testing.assert_array_equal(bump.rate(x)[:, 1], bump.rate(x[:, 1]))


def test_too_narrow_a_bump_is_refused() -> None:
    with pytest.raises(InputError, match="three samples"):
        Bump.of(2, 0.1)


@pytest.mark.parametrize("delay", [0.0, 0.004, -0.013, 0.05])
def test_what_comes_late_is_the_same_signal_later(delay: float) -> None:
    step = 0.01
    bump = Bump.of(20, step)
    t = np.arange(600) * step
    signal, later = np.sin(3.0 * t) + 0.2 * np.cos(7.0 * t), np.sin(3.0 * (t - delay)) + 0.2 * np.cos(7.0 * (t - delay))
    inside = slice(20, -20)
    np.testing.assert_allclose(bump.late(signal, delay)[inside], bump.smooth(later)[inside], atol=2e-5)


def test_noise_is_no_delay() -> None:
    """Of a signal under noise no delay is likelier than none: the remainder does not shrink with the noise."""
    bump = Bump.of(10, 0.01)
    random = np.random.default_rng(5)
    spread = []
    for delay in (0.0, 0.0049, -0.0049):
        some = [bump.late(random.standard_normal(400), delay) for _ in range(200)]
        spread.append(float(np.std(some)))
    assert spread == pytest.approx([spread[0]] * 3, rel=0.05)
