"""95 % intervals of a fit's values, from the curvature at its best point."""

from __future__ import annotations

import math
from collections.abc import Mapping

from spacerobot.diagnosis.fitting.fitted import Fit

NORMAL_95 = 1.959963984540054


def interval(fit: Fit, key: str, inflation: float) -> tuple[float, tuple[float, float]]:
    """A free parameter's value and its 95 % interval, initial values and all other parameters marginalised."""
    index = fit.hypothesis.keys.index(key)
    free, z = fit.hypothesis.free[index], float(fit.z[index])
    spread = math.inf
    if fit.covariance is not None:
        spread = NORMAL_95 * math.sqrt(max(float(fit.covariance[index, index]), 0.0) * inflation)
    if not math.isfinite(spread) or spread > 1e6:
        return free.value(z), (free.lower, free.upper)
    return free.value(z), (free.value(z - spread), free.value(z + spread))


Intervals = Mapping[str, tuple[float, float]]
"""95 % intervals found by profile likelihood, by key; those of the curvature at the best fit where one is absent."""
