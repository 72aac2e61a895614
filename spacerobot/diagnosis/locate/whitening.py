"""Residuals in units of their noise: sensor noise through the weights, believed values within their sigmas."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.linalg import solve_triangular

from spacerobot.diagnosis.locate.samples import Integral
from spacerobot.diagnosis.locate.weak_trial import WeakTrial

RIDGE = 1e-9
"""Added to the diagonal of a covariance, as a share of its own mean: test functions overlap."""


class Whitener:
    """Turns rows of balances into numbers of variance one under the model. R rows."""

    def __init__(self, covariance: np.ndarray) -> None:
        size = covariance.shape[0]
        scale = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        correlation = covariance / scale[:, None] / scale[None, :]
        self._scale = scale
        self._lower = np.linalg.cholesky(correlation + RIDGE * np.eye(size))

    def __call__(self, rows: np.ndarray) -> np.ndarray:
        """Whitened rows, shape (R,) or (R, K)."""
        scaled = (rows.T / self._scale).T
        return np.asarray(solve_triangular(self._lower, scaled, lower=True, check_finite=False))


def noise(weak: WeakTrial, residual: Integral) -> np.ndarray:
    """Covariance of integrals from independent sensor noise, shape (R, R)."""
    size = residual.value.size
    out = np.zeros((size, size))
    for channel, weights in residual.weights.items():
        scaled = weights * weak.sigma(channel, weights.shape[1])[None, :]
        out += (scaled @ scaled.T).toarray()
    return out


def with_directions(covariance: np.ndarray, directions: Mapping[str, np.ndarray]) -> np.ndarray:
    """Covariance with further independent errors along directions, shape (R,) each, one standard deviation long."""
    if not directions:
        return covariance
    columns = np.stack(list(directions.values()), axis=1)
    return np.asarray(covariance + columns @ columns.T)
