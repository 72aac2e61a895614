"""Compact test functions: a smooth window and its derivatives, applied alike to both sides of a balance.

Multiplying a balance by a bump phi and integrating by parts moves the derivatives from the data to phi (the weak
form; Messenger and Bortz 2021, SIAM Multiscale Model. Simul. 19, Eq. 2.4): the acceleration seen through phi is
the integral of phi'' q, and no measured signal is ever differentiated twice.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.support.errors import InputError

POWER = 4
"""phi = (1 - s^2)^POWER: three derivatives vanish at the ends."""

RATE = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
CURVE = np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) / 12.0
"""Differences of fourth order (Fornberg 1988, Table 1). Taken of the sampled bump, they make its derivatives belong
to it exactly: sampled analytic derivatives of a narrow bump pass 2 % more acceleration than the bump passes force."""


@dataclass(frozen=True, eq=False)
class Bump:
    """A test function on an even grid: weights of a sample sum, shape (2 n + 1,), unit area.

    Attributes:
        half: n, samples to either side.
        weight: smooths.
        slope: gives the smoothed first derivative, per second.
        curve: gives the smoothed second derivative, per second squared.
        step: of the grid [s].
    """

    half: int
    weight: np.ndarray
    slope: np.ndarray
    curve: np.ndarray
    step: float

    @classmethod
    def of(cls, half: int, step: float) -> Bump:
        """The bump of `half` samples to either side on a grid of `step` seconds.

        Raises:
            InputError: fewer than three samples to either side cannot carry two derivatives.
        """
        if half < 3 or not step > 0.0:
            raise InputError("a test function needs three samples to either side", given=half)
        inner = half - 2
        shape = (1.0 - (np.arange(-inner, inner + 1) / (inner + 1.0)) ** 2) ** POWER
        shape /= shape.sum()
        return cls(half, np.pad(shape, 2), np.convolve(shape, RATE) / step, np.convolve(shape, CURVE) / step**2, step)

    @property
    def variance(self) -> float:
        """Its second moment [s^2]; half of it times a signal's second derivative is what smoothing adds."""
        at = np.arange(-self.half, self.half + 1) * self.step
        return float(self.weight @ at**2)

    def smooth(self, x: np.ndarray) -> np.ndarray:
        """The signal seen through the bump, shape (T - 2 n, ...) for a signal of shape (T, ...)."""
        return _apply(self.weight, x)

    def late(self, x: np.ndarray, delay: float) -> np.ndarray:
        """What comes so much later [s], seen through the bump, shape (T - 2 n,) for (T,); its ends go on as they are.

        Whole samples are moved, the rest is what the bump's derivatives make of it (Taylor, third order left out):
        between samples lines would smooth the noise of x, and a fit would take that for a delay.
        """
        if delay == 0.0:
            return self.smooth(x)
        samples = int(np.clip(round(delay / self.step), -x.size + 1, x.size - 1))
        rest = delay - samples * self.step
        ends = (max(samples, 0), max(-samples, 0))
        moved = _goes_on(x, *ends)[ends[1] : ends[1] + x.size]
        return self.smooth(moved) - rest * self.rate(moved) + 0.5 * rest**2 * self.acceleration(moved)

    def blurred(self, x: np.ndarray) -> np.ndarray:
        """The same of a signal that goes on at its ends as it is there, shape (T,) both."""
        return self.smooth(_goes_on(x, self.half, self.half))

    def rate(self, x: np.ndarray) -> np.ndarray:
        """Its first derivative seen through the bump."""
        return _apply(self.slope, x)

    def acceleration(self, x: np.ndarray) -> np.ndarray:
        """Its second derivative seen through the bump."""
        return _apply(self.curve, x)


def _goes_on(x: np.ndarray, before: int, after: int) -> np.ndarray:
    """The signal with so many more samples at its ends, as it is there, shape (before + T + after,) of (T,)."""
    return np.concatenate([np.full(before, x[0]), x, np.full(after, x[-1])])


def _apply(kernel: np.ndarray, x: np.ndarray) -> np.ndarray:
    if x.ndim == 1:
        return np.convolve(x, kernel[::-1], "valid")
    return np.stack([np.convolve(c, kernel[::-1], "valid") for c in x.T], axis=1)
