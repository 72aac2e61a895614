"""By how much a stream's own clock is late, tried at every offset against one simulated trial.

A contact that rings looks alike one period on: the misfit of a force on a clock of its own has as many minima as the
force has peaks, and a descent ends in the nearest. The whole curve is two correlations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.signal import correlate

from spacerobot.diagnosis.terms.data import Block

STEP = 5e-4
"""Between offsets that are tried [s]: a descent goes on from there. No rig's contact rings faster than 500 Hz."""


def best_offset(blocks: Sequence[Block], shown: Callable[[Sequence[str], np.ndarray], np.ndarray]) -> float:
    """The offset [s], positive where the readings are late, at which a prediction fits those of one clock best.

    Args:
        blocks: all that is on the clock; offsets to half its length are tried, to either side.
        shown: what C channels would read at times, shape (G,) [s], of the trial's clock: shape (C, G) [SI].
    """
    first, last = min(float(b.time[0]) for b in blocks), max(float(b.time[-1]) for b in blocks)
    size = round((last - first) / STEP) + 1
    reach = size // 2
    tried = first + STEP * np.arange(-reach, size + reach)
    misfit = np.zeros(2 * reach + 1)  # but for what is the same at every offset
    for block in blocks:
        at = np.rint((block.time - first) / STEP).astype(int)
        for value, weight, one in zip(block.value, block.weight, shown(block.channels, tried), strict=True):
            counted = np.bincount(at, weight**2, size)
            measured = np.bincount(at, weight**2 * value, size)
            misfit += correlate(one**2, counted, "valid") - 2.0 * correlate(one, measured, "valid")
    return STEP * (reach - int(np.argmin(misfit)))
