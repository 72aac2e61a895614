"""One value of which several tell: the surer ones count for more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Pooled:
    """A weighted mean.

    Attributes:
        value: the mean.
        error: its standard error, by those of who tells.
        scatter: rms of what they tell about it, weighted alike.
    """

    value: float
    error: float
    scatter: float


def pooled(values: Sequence[float] | np.ndarray, errors: Sequence[float] | np.ndarray) -> Pooled:
    """The mean of values by their inverse variances, from these standard errors, shape (N,) each, N at least 1."""
    told, weight = np.asarray(values, dtype=float), 1.0 / np.maximum(np.square(errors), np.finfo(float).tiny)
    total = float(weight.sum())
    mean = float(weight @ told / total)
    return Pooled(mean, total**-0.5, float(np.sqrt(weight @ (told - mean) ** 2 / total)))
