"""How much noise the readings of a track have: as the study states it, or as they scatter from one to the next."""

from __future__ import annotations

from collections.abc import Container, Iterable

import numpy as np

from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.recordings.series import estimate_noise


def readings_noise(trials: Iterable[TrialData], stated: Container[str], *, scatter: bool) -> dict[str, float]:
    """Channel -> one standard deviation of its noise, in its unit.

    Args:
        trials: as they were recorded; where noise is stated their weights are one over it.
        stated: channels whose noise is stated.
        scatter: whether the others are told by their scatter, in the middle one of the trials: a lower bound of what a
            sensor errs by.
    """
    found: dict[str, list[float]] = {}
    for trial in trials:
        for channel in trial.channels:
            _, value, weight = trial.channel(channel)
            good = weight > 0.0
            if channel in stated and good.any():
                found.setdefault(channel, []).append(1.0 / float(weight[good].max()))
            elif scatter and channel not in stated:
                found.setdefault(channel, []).append(estimate_noise(value[good]))
    seen = {c: [x for x in some if np.isfinite(x)] for c, some in found.items()}
    return {c: float(np.median(some)) for c, some in seen.items() if some}
