"""The two special functions that the closed forms need: Lambert's W0 and a ratio of Gammas."""

from __future__ import annotations

import math

_BRANCH = -math.exp(-1.0)


def lambert_w0(x: float) -> float:
    """The principal branch of Lambert's W: w exp(w) = x with w >= -1.

    Halley's iteration from an asymptotic start (Corless et al. 1996, "On the Lambert W function", Secs. 4 and
    5). Next to the branch point x = -1/e, W is a square root of the distance to it: there half of the digits
    of x are what the result can have.

    Args:
        x: the argument, at least -1/e.

    Returns:
        W0(x).

    Raises:
        ValueError: x is below -1/e or not finite.
    """
    if not math.isfinite(x) or x < _BRANCH * (1 + 4e-16):
        raise ValueError(f"W0 is defined from -1/e up; given: {x!r}")
    if x < -0.25:
        p = math.sqrt(max(2.0 * (math.e * x + 1.0), 0.0))
        w = -1.0 + p * (1.0 - p / 3.0 + 11.0 * p * p / 72.0)
        if p < 1e-4:
            return w
    elif x < math.e:
        w = x / (1.0 + x)  # slope 1 at zero, like W0
    else:
        w = math.log(x) - math.log(math.log(x))
    for _ in range(50):
        e = math.exp(w)
        residual = w * e - x
        step = residual / (e * (w + 1.0) - (w + 2.0) * residual / (2.0 * w + 2.0))
        w -= step
        if abs(step) <= 1e-16 * (1.0 + abs(w)):
            break
    return w


def gamma_ratio(a: float, b: float) -> float:
    """Gamma(a)/Gamma(b) for positive a and b, without overflow."""
    return math.exp(math.lgamma(a) - math.lgamma(b)) if max(a, b) > 100 else math.gamma(a) / math.gamma(b)
