"""Value and slope at a moment: right, and as uncertain as they say, with hardly more readings than a cubic needs."""

from __future__ import annotations

import numpy as np

from spacerobot.diagnosis.machines.windows import local


def test_pulls_have_variance_one() -> None:
    random = np.random.default_rng(4)
    time = np.linspace(0.0, 1.0, 10)
    pulls, squares = [], []
    for _ in range(2000):
        found = local(time, 0.5 + 2.0 * time + 0.1 * random.standard_normal(time.size), 0.0, 2.0)
        squares.append(found.value_sigma**2)
        pulls.append(found.value - 0.5)
    assert 0.9 < np.mean(np.square(pulls)) / np.mean(squares) < 1.1
