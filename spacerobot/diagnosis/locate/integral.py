"""A vector of integrals that is linear in the samples of some channels: its value, and what its noise comes from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False)
class Integral:
    """One number per test function. I test functions.

    Attributes:
        value: shape (I,).
        weights: channel -> weight of each of its samples, shape (I, T).
    """

    value: np.ndarray
    weights: Mapping[str, csr_array] = field(default_factory=dict)

    def __add__(self, other: Integral) -> Integral:
        weights = dict(self.weights)
        for channel, matrix in other.weights.items():
            weights[channel] = weights[channel] + matrix if channel in weights else matrix
        return Integral(self.value + other.value, weights)

    def __mul__(self, factor: float) -> Integral:
        return Integral(self.value * factor, {c: w * factor for c, w in self.weights.items()})

    __rmul__ = __mul__

    def rows(self, keep: np.ndarray) -> Integral:
        """Those test functions where `keep`, shape (I,) bool, is true."""
        return Integral(self.value[keep], {c: csr_array(w[keep]) for c, w in self.weights.items()})


def total(parts: list[Integral], count: int) -> Integral:
    """The sum of integrals over the same `count` test functions."""
    out = Integral(np.zeros(count))
    for part in parts:
        out = out + part
    return out
