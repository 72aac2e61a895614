"""Compact test functions: cubic B-splines inside a stretch of time, and plateaus whose curvature spares the touches.

For a test function phi that vanishes with its slope at both ends, int phi q'' dt = int phi'' q dt: a balance is
tested without differentiating a measured position (the weak form; Messenger and Bortz 2021, SIAM Multiscale Model.
Simul. 19, Eq. 2.4).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array

DEGREE = 3

CUBIC = (
    np.array([[-1.0, 3.0, -3.0, 1.0], [3.0, -6.0, 0.0, 4.0], [-3.0, 3.0, 3.0, 1.0], [1.0, 0.0, 0.0, 0.0]]) / 6.0,
    np.array([[-1.0, 2.0, -1.0], [3.0, -4.0, 0.0], [-3.0, 2.0, 1.0], [1.0, 0.0, 0.0]]) / 2.0,
    np.array([[-1.0, 1.0], [3.0, -2.0], [-3.0, 1.0], [1.0, 0.0]]),
)
"""The four pieces of an even cubic B-spline and of its derivatives, the last first, as polynomials of 0 to 1."""

Entries = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Values, and the test function and the time of each."""


@dataclass(frozen=True)
class Splines:
    """All cubic B-splines on even knots that vanish outside [start, end].

    Attributes:
        start, end: s.
        pieces: number of knot intervals, at least 4; there are pieces - 3 test functions, four intervals wide.
    """

    start: float
    end: float
    pieces: int

    @classmethod
    def fitting(cls, start: float, end: float, spacing: float) -> Splines | None:
        """Those with knots about `spacing` [s] apart; None where not even one test function fits."""
        pieces = int((end - start) / spacing + 1e-9)
        return cls(start, end, pieces) if pieces > DEGREE else None

    @property
    def spacing(self) -> float:
        """Distance of the knots [s]."""
        return (self.end - self.start) / self.pieces

    @property
    def count(self) -> int:
        """Number of test functions."""
        return self.pieces - DEGREE

    @property
    def centres(self) -> np.ndarray:
        """Time of each peak, shape (count,) [s]."""
        return self.start + self.spacing * (np.arange(self.count) + 0.5 * (DEGREE + 1))

    def entries(self, times: np.ndarray, order: int) -> Entries:
        """Derivative of this order (0, 1 or 2) at ascending times [s^-order], where it is not zero."""
        first, last = np.searchsorted(times, [self.start, self.end])
        along = (times[first:last] - self.start) / self.spacing
        piece = np.minimum(along.astype(int), self.pieces - 1)
        u = along - piece
        value = np.array([np.polyval(p, u) for p in CUBIC[order]]) / self.spacing**order
        row = piece + np.arange(-DEGREE, 1)[:, None]
        kept = (row >= 0) & (row < self.count)
        return value[kept], row[kept], np.broadcast_to(np.arange(first, last), row.shape)[kept]


@dataclass(frozen=True)
class Plateau:
    """One on [flat_start, flat_end], with ramps u^3 (10 - 15 u + 6 u^2) that reach zero at start and end.

    Its integral against a balance is the change of momentum between the ramps. Where it is flat it asks nothing of
    a position, so a touch may lie there.
    """

    start: float
    flat_start: float
    flat_end: float
    end: float

    count = 1

    @property
    def centres(self) -> np.ndarray:
        """Middle of the flat part, shape (1,) [s]."""
        return np.array([0.5 * (self.flat_start + self.flat_end)])

    def entries(self, times: np.ndarray, order: int) -> Entries:
        """Derivative of this order (0, 1 or 2) at ascending times [s^-order], where it is not zero."""
        rise, fall = self.flat_start - self.start, self.end - self.flat_end
        up = _ramp(np.clip((times - self.start) / rise, 0.0, 1.0), order) / rise**order
        down = _ramp(np.clip((self.end - times) / fall, 0.0, 1.0), order) / (-fall) ** order
        value = up * down if order == 0 else up + down
        column = np.flatnonzero(value)
        return value[column], np.zeros(column.size, dtype=int), column

    def breaks(self) -> tuple[float, float, float, float]:
        """Where its formula changes [s]."""
        return self.start, self.flat_start, self.flat_end, self.end


def _ramp(u: np.ndarray, order: int) -> np.ndarray:
    if order == 0:
        return u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
    if order == 1:
        return 30.0 * u**2 * (1.0 - u) ** 2
    return 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)


@dataclass(frozen=True)
class Windows:
    """The test functions of one trial, in order. I test functions."""

    parts: tuple[Splines | Plateau, ...]

    @property
    def count(self) -> int:
        """I."""
        return sum(p.count for p in self.parts)

    @property
    def centres(self) -> np.ndarray:
        """Time of each, shape (I,) [s]."""
        return np.concatenate([p.centres for p in self.parts])

    def values(self, times: np.ndarray, order: int) -> csr_array:
        """Derivative of this order at ascending times, shape (I, len(times)) [s^-order]."""
        first = np.cumsum([0, *(p.count for p in self.parts)])
        found = [p.entries(times, order) for p in self.parts]
        value, row, column = (np.concatenate([f[k] for f in found]) for k in range(3))
        row += np.repeat(first[:-1], [f[0].size for f in found])
        return csr_array((value, (row, column)), shape=(int(first[-1]), times.size))

    def nodes(self, per_piece: int = 5) -> tuple[np.ndarray, np.ndarray]:
        """Gauss-Legendre nodes and weights between all knots and breaks, shape (Q,) [s] each."""
        edges: list[np.ndarray] = []
        for part in self.parts:
            if isinstance(part, Splines):
                edges.append(np.linspace(part.start, part.end, part.pieces + 1))
            else:
                edges.append(np.array(part.breaks()))
        found = np.unique(np.concatenate(edges))
        finest = min((p.spacing for p in self.parts if isinstance(p, Splines)), default=np.inf)
        if np.isfinite(finest):  # long ramps and gaps are divided too
            cuts = [np.linspace(a, b, int(np.ceil((b - a) / finest - 1e-9)) + 1)[:-1] for a, b in pairwise(found)]
            found = np.append(np.concatenate(cuts), found[-1])
        return gauss(found, per_piece)


def gauss(edges: Sequence[float] | np.ndarray, per_piece: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights on each interval of `edges`, shape (Q,) each, ascending."""
    edges = np.asarray(edges, dtype=float)
    x, w = np.polynomial.legendre.leggauss(per_piece)
    half = 0.5 * np.diff(edges)
    nodes = (edges[:-1] + half)[:, None] + half[:, None] * x
    return nodes.ravel(), (half[:, None] * w).ravel()
