"""Integrals of test functions against channels: weights on the samples, the value, and what its noise comes from."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array, diags_array

from spacerobot.diagnosis.locate.windows import Windows

POINTS = 6
"""Samples that an interpolation between sparse samples reads (a polynomial of degree 5)."""

DENSE = 6.0
"""A channel with this many samples a knot interval is summed as it is, by the trapezoid rule."""

FEWEST_NODES = 5
"""Gauss nodes a knot interval."""


@dataclass(frozen=True, eq=False)
class Grid:
    """Times at which integrands with one set of samples are evaluated. I test functions, N nodes, T samples.

    Attributes:
        nodes: ascending, shape (N,) [s].
        phi: test functions and their first and second derivatives times the quadrature weights, shape (I, N) each.
        read: from samples to nodes, shape (N, T).
    """

    nodes: np.ndarray
    phi: tuple[csr_array, csr_array, csr_array]
    read: csr_array

    @classmethod
    def of(cls, windows: Windows, time: np.ndarray, spacing: float, *, bent: bool = False) -> Grid:
        """For samples at `time`, shape (T,), with test functions whose knots are `spacing` apart.

        Args:
            windows: the test functions.
            time: ascending [s].
            spacing: of the knots [s].
            bent: whether second derivatives are asked for. They have kinks, which a sum over samples does not
                forgive: then samples are interpolated, at enough nodes that each is read.
        """
        step = float(np.median(np.diff(time))) if time.size > 1 else np.inf
        dense = spacing / step
        if dense >= DENSE and not bent:
            nodes, weight = time, trapezoid(time)
            read = csr_array(diags_array(np.ones(time.size)))
        else:
            nodes, weight = windows.nodes(max(FEWEST_NODES, math.ceil(2.0 * dense)))
            read = interpolation(time, nodes)
        return cls.over(windows, nodes, weight, csr_array(read))

    @classmethod
    def over(cls, windows: Windows, nodes: np.ndarray, weight: np.ndarray, read: csr_array | None = None) -> Grid:
        """From nodes and quadrature weights, shape (N,) each; `read` is the identity where absent."""
        scale = diags_array(weight)
        first, second, third = (csr_array(windows.values(nodes, k) @ scale) for k in range(3))
        same = csr_array(diags_array(np.ones(nodes.size))) if read is None else read
        return cls(nodes, (first, second, third), same)

    def weights(self, order: int, modulation: np.ndarray | None = None) -> csr_array:
        """int phi^(order) c y dt as weights on the samples of y, shape (I, T), with c given at the nodes."""
        left = self.phi[order]
        if modulation is not None:
            left = left @ diags_array(modulation)
        return csr_array(left @ self.read)

    def integral(self, order: int, values: np.ndarray) -> np.ndarray:
        """int phi^(order) y dt, shape (I,), of y given at the nodes, shape (N,)."""
        return np.asarray(self.phi[order] @ values)


def trapezoid(time: np.ndarray) -> np.ndarray:
    """Weights of the trapezoid rule, shape (T,) [s]."""
    step = np.diff(time)
    return 0.5 * np.concatenate([step[:1], step[:-1] + step[1:], step[-1:]])


def interpolation(time: np.ndarray, at: np.ndarray) -> csr_array:
    """Local Lagrange interpolation from samples at `time`, shape (T,), to `at`, shape (N,); returns (N, T).

    Outside the samples the end value is held.
    """
    points = min(POINTS, time.size)
    inside = np.clip(at, time[0], time[-1])
    first = np.clip(np.searchsorted(time, inside) - points // 2, 0, time.size - points)
    columns = first[:, None] + np.arange(points)
    t = time[columns]
    value = np.ones(columns.shape)
    for j in range(points):
        for k in range(points):
            if k != j:
                value[:, j] *= (inside - t[:, k]) / (t[:, j] - t[:, k])
    rows = np.repeat(np.arange(at.size), points)
    return csr_array((value.ravel(), (rows, columns.ravel())), shape=(at.size, time.size))


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
