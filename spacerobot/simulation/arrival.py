"""When a body that is pulled on arrives."""

from __future__ import annotations

from typing import Any

import numpy as np


def arrival_time(gap: Any, speed: Any, pull: Any) -> Any:
    """The first time t at which gap - speed t - pull t^2 / 2 is zero, of the arguments' shape [s].

    Where a pull the other way turns the body back before, the time that it would take without: an effect, or the wrist,
    may meet it half-way. Infinite where nothing brings it.

    Args:
        gap: at the start, not negative [m].
        speed: closing; negative while it recedes [m/s].
        pull: acceleration that brings it [m/s^2].
    """
    gap, speed, pull = (np.asarray(x, dtype=float) for x in (gap, speed, pull))
    root = np.sqrt(np.maximum(speed * speed + 2.0 * pull * gap, 0.0))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        closing = np.where(speed * speed + 2.0 * pull * gap > 0.0, 2.0 * gap / (speed + root), gap / speed)
        receding = np.where(pull > 0.0, (root - speed) / pull, np.inf)  # the form without cancellation
    found = np.where(speed > 0.0, closing, receding)
    return float(found) if found.ndim == 0 else found
