"""Is a pattern in the residuals more than noise? Scores, p-values, sign flips of whole trials, Holm's correction."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
from scipy.special import betaln, gammaln, hyp2f1, log_ndtr

MOST_EXACT = 12
"""Up to this many units all sign flips are tried."""

SMALLEST = 1e-290
"""Tail probabilities below it have lost digits, or all of them, to the smallest float of 1e-308."""

TERMS = 300
"""Of an asymptotic series where x is some 1300 at least, the least of which the smallest float asks for."""

RANDOM_FLIPS = 4096
MOST_UNITS = 512


def log_p_normal(z: float) -> float:
    """Natural log of the two-sided p-value of a standard normal score."""
    return float(min(np.log(2.0) + log_ndtr(-abs(z)), 0.0))


def log_p_student(t: float, freedom: int) -> float:
    """Natural log of the two-sided p-value of Student's t, also far beyond the smallest float.

    There the incomplete beta function is taken by its own series (Abramowitz and Stegun 26.7.1, 26.5.4).
    """
    from scipy.stats import t as student

    found = float(student.sf(abs(t), freedom))
    if found > SMALLEST:
        return min(math.log(2.0) + math.log(found), 0.0)
    half, log_ratio = 0.5 * freedom, 2.0 * math.log(math.hypot(1.0, abs(t) / math.sqrt(freedom)))
    ratio = math.exp(-log_ratio)  # freedom / (freedom + t^2)
    series = math.log(hyp2f1(half + 0.5, 1.0, half + 1.0, ratio)) + 0.5 * math.log1p(-ratio)
    return float(-half * log_ratio + series - math.log(half) - betaln(half, 0.5))


def log_p_chi2(x: float, freedom: int) -> float:
    """Natural log of the upper tail of chi-squared, also far beyond the smallest float."""
    from scipy.stats import chi2

    found = float(chi2.sf(x, freedom))
    if found > SMALLEST:
        return min(math.log(found), 0.0)
    half, z = 0.5 * freedom, 0.5 * x
    series = 1.0 + np.cumprod((half - np.arange(1.0, TERMS)) / z).sum()  # Abramowitz and Stegun 6.5.32
    return float(-z + (half - 1.0) * math.log(z) - gammaln(half) + math.log(series))


def combined(log_p: float, tries: int) -> float:
    """Log of the p-value of the best of several independent tries (Sidak)."""
    p = math.exp(log_p)
    if p * tries < 1e-6:
        return log_p + math.log(tries)
    return math.log(-math.expm1(tries * math.log1p(-min(p, 1.0 - 1e-16))))


@functools.cache
def _random_signs() -> np.ndarray:
    rng = np.random.default_rng(0)  # always the same: no answer hangs on it
    flips = np.where(rng.random((RANDOM_FLIPS, MOST_UNITS)) < 0.5, -1.0, 1.0).astype(np.float32)
    flips[0] = 1.0
    return flips


def sign_flips(units: int) -> np.ndarray:
    """Rows of +-1, the first all +1, shape (B, units): all of them, or as many at random, at most MOST_UNITS."""
    if units <= MOST_EXACT:
        codes = np.arange(2 ** max(units - 1, 0))  # the other half are mirror images
        return 1.0 - 2.0 * ((codes[:, None] >> np.arange(units)) & 1)
    return _random_signs()[:, :units]


def flip_p(scores: np.ndarray) -> float:
    """Share of sign patterns under which the units' scores, shape (U,), agree at least as well as they do.

    Units without any score are left out; of very many, neighbours flip together.
    """
    told = scores[np.abs(scores) > 1e-9 * np.abs(scores).max(initial=0.0)]
    if told.size > MOST_UNITS:
        told = np.add.reduceat(told, np.arange(0, told.size, -(-told.size // MOST_UNITS)))
    sums = np.abs(sign_flips(told.size) @ (told / max(np.abs(told).max(initial=0.0), 1e-300)))
    return float(np.mean(sums >= sums[0] * (1.0 - 1e-6)))


def holm(log_p: Sequence[float]) -> list[float]:
    """p-values corrected for their number (Holm 1979), in the order given.

    Args:
        log_p: natural logs of the plain p-values.
    """
    order = np.argsort(log_p)
    count = len(order)
    out = [1.0] * count
    worst = -math.inf
    for rank, index in enumerate(order):
        worst = max(worst, log_p[index] + math.log(count - rank))
        out[index] = min(1.0, math.exp(min(worst, 0.0)))
    return out
