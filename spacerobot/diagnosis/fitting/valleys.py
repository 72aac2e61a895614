"""Other valleys of a fit's cost along one of its values, as they look from where it stands.

The value is set elsewhere and simulated; all else follows to first order, by the derivatives at the fit. Where a
contact rings, a few readings decide between a damping and one three times as large, and no fit climbs from the one
to the other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import RESCUE_GAIN, Fitter

FACTOR, STEPS = 1.25, 22
"""Between the values that are tried, and how many either way: up to a hundred times as much, and as little."""

DAMPING = 1e-6
"""Of the step of all else, as a share of the curvature: what nothing shows stays where it is."""

LOWEST = 3
"""Valleys that are looked into."""

ROUNDS = 3
"""Valleys that one fit may move on to."""


@dataclass(frozen=True, eq=False)
class Valley:
    """A start in another valley.

    Attributes:
        promised: cost there, to first order.
        values: by key.
        initials: of the trials, shape (N,) each.
    """

    promised: float
    values: Mapping[str, float]
    initials: Mapping[str, np.ndarray]


def valleys(fitter: Fitter, fit: Fit, key: str) -> list[Valley]:
    """Where the cost along a value is lowest between higher ones, and lower than that of the fit; the lowest first.

    Args:
        fitter: that made the fit.
        fit: finished.
        key: of a value of it that is not zero.

    Raises:
        SimulationError: the fit can no longer be simulated.
    """
    seen = [there(fitter, fit, key, float(by)) for by in FACTOR ** np.arange(-STEPS, STEPS + 1.0)]
    cost = np.array([np.inf, *map(_promised, seen), np.inf])
    low = np.flatnonzero((cost[1:-1] < cost[:-2]) & (cost[1:-1] < cost[2:]))
    low = low[np.abs(low - STEPS) > 1]  # about the fit is its own valley
    found = []
    for k in sorted(low, key=lambda k: cost[k + 1])[:LOWEST]:
        before, here, after = cost[k : k + 3]
        bend = before - 2.0 * here + after  # a step of the search is wide: by its parabola the valley is deeper
        found.append(seen[k])
        if np.isfinite(bend):
            aside = 0.5 * (before - after) / bend
            if here - 0.5 * bend * aside**2 < fit.cost - RESCUE_GAIN:
                found.append(there(fitter, fit, key, float(FACTOR ** (k - STEPS + aside))))
    return sorted((v for v in found if v is not None and v.promised < fit.cost - RESCUE_GAIN), key=_promised)


def _promised(valley: Valley | None) -> float:
    return np.inf if valley is None else valley.promised


def there(fitter: Fitter, fit: Fit, key: str, factor: float) -> Valley | None:
    """A value of a fit so many times as large, and all else as it follows; None where that cannot be simulated."""
    made = fit.hypothesis
    low, high = made.bounds()
    index, values = made.keys.index(key), fit.values()
    z = np.clip(made.start({**values, key: factor * values[key]}), low, high)
    state = fitter.state(made, z, fit.initials())
    if state is None:
        return None
    low[index] = high[index] = z[index]
    normal = fitter.normal(state, fitter.rows_at(fit), made.precision)
    dz, dn, fall = normal.step(DAMPING, z, low, high)
    cost = state.chi2() + float(z @ made.precision @ z)
    return Valley(cost - fall, made.values(z + dz), fitter.own_moved(state, dn))


def deepest(fitter: Fitter, fit: Fit, keys: Iterable[str], *, max_iterations: int, hopeless: float = np.inf) -> Fit:
    """The fit, moved on to lower valleys along these values while there are any.

    Args:
        fitter: that made it.
        fit: finished.
        keys: of positive values; those that it does not have are passed over.
        max_iterations: of each further fit.
        hopeless: cost above which a further fit may be given up.
    """
    for key in [k for k in keys if k in fit.hypothesis.keys]:
        for _ in range(ROUNDS):
            others = valleys(fitter, fit, key)
            if not others:
                break
            again = fitter.fit(
                fit.hypothesis,
                warm=others[0].values,
                initials=others[0].initials,
                max_iterations=max_iterations,
                hopeless=hopeless,
                robust=False,
            )
            if not again.cost < fit.cost - RESCUE_GAIN:
                break
            fit = again
    return fit
