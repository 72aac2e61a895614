"""A step of a fit within bounds is the best one there is: no lower cost beside it, and none promised in vain."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.fitting.normal_equations import Normal


def _normal(seed: int, size: int) -> tuple[Normal, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    jacobians = [rng.normal(size=(30, size + 2)) @ np.diag(10.0 ** rng.uniform(-1, 1, size + 2)) for _ in range(3)]
    residuals = [rng.normal(size=30) for _ in range(3)]
    z = rng.normal(size=size) * 0.3
    low = np.where(rng.random(size) < 0.5, np.minimum(z, rng.normal(size=size) * 0.2), -np.inf)
    high = np.where(rng.random(size) < 0.2, np.maximum(low, z), np.inf)  # some of them held where they are
    low = np.where(np.isfinite(high), high, low)
    return Normal.build(jacobians, residuals, z, np.diag(rng.uniform(0.0, 2.0, size))), z, low, high


@given(seed=st.integers(0, 2**32 - 1), size=st.integers(1, 7))
def test_step_satisfies_the_conditions_of_a_bounded_minimum(seed: int, size: int) -> None:
    """Karush, Kuhn and Tucker: no slope where a value is free, one that pushes outwards where it is at its bound."""
    normal, z, low, high = _normal(seed, size)
    dz, _, promised = normal.step(0.0, z, low, high)
    if np.abs(dz).max() > 19.0:  # cut short on purpose
        return
    slope = normal.gradient + normal.reduced @ dz
    size_of_slope = 1e-6 * (1.0 + np.abs(normal.gradient).max())
    held, at_bound = low == high, (z + dz <= low + 1e-9) & (low < high)
    assert np.all(z + dz >= low - 1e-9)
    assert np.abs(slope[~at_bound & ~held]).max(initial=0.0) < size_of_slope
    assert slope[at_bound].min(initial=0.0) > -size_of_slope
    assert promised >= -1e-9


def test_a_free_step_cut_short_would_not_do() -> None:
    """Two values that trade with each other: cut at the first one's bound, the second stays far from its best."""
    reduced = np.array([[1.0, 0.99], [0.99, 1.0]])
    gradient = np.array([1.0, 0.5])
    normal = Normal(reduced, gradient, [], reduced)
    z, low, high = np.zeros(2), np.array([-0.1, -np.inf]), np.full(2, np.inf)
    dz, _, promised = normal.step(0.0, z, low, high)
    cut = np.clip(-np.linalg.solve(reduced, gradient), low, high)
    assert promised > 0.0 > -(2.0 * gradient @ cut + cut @ reduced @ cut)
    np.testing.assert_allclose(dz, [-0.1, -(0.5 - 0.099)], rtol=1e-9)
