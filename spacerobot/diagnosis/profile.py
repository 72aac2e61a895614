"""Intervals by profile likelihood: a parameter is held further and further from its best value, all else refitted.

Contact makes the cost curved, so that the curvature at the best fit alone understates or overstates an interval.
"""

from __future__ import annotations

import math
from dataclasses import replace

from spacerobot.diagnosis.fit import Fitter
from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.hypothesis import Hypothesis
from spacerobot.diagnosis.starts import known_rows
from spacerobot.support.errors import SimulationError

LEVEL_95 = 3.841458820694124
"""Rise of the cost at the ends of a 95 % interval: chi-squared of one degree of freedom."""

NEARBY = 3.0
"""Ratio of the curvature's interval to the profile's up to which the wider counts. A refit among contacts may end above
its best, which brings the profile's end too near; where the two differ by more, the cost is no parabola."""

MOMENT = 150.0
FURTHER, OUTSIDE = 20, 5
"""What happens at a moment fits at several, with noise between them. One step of a search further out is such a part of
the longest trial; it takes so many steps at most, and ends after so many outside the interval in a row."""

TRIES, STRIDE = 6, 5.0
FLAT = 0.5
"""Each step of a search for an end is up to five times the one before. Where, after six, the cost has not risen by this
share of the level, it does not rise before the bound as far as anybody can tell."""

CLOSE = 0.1
"""Share of the level within which an end counts as met."""


def profile_interval(fitter: Fitter, fit: Fit, key: str, inflation: float) -> tuple[float, float]:
    """A parameter's 95 % interval.

    Args:
        fitter: of the trials the fit was made to.
        fit: the best fit.
        key: of the free parameter.
        inflation: rise of the cost that counts as one, for noise that is larger or more coloured than stated.

    Returns:
        lower and upper end, physical; a bound of the parameter where the cost does not rise before it.
    """
    index = fit.hypothesis.keys.index(key)
    free = fit.hypothesis.free[index]
    variance = 0.0 if fit.covariance is None else float(fit.covariance[index, index]) * inflation * LEVEL_95
    known = 0.0 < variance < 1e6
    spread = math.sqrt(variance) if known else 1.0
    best, (low, high) = float(fit.z[index]), free.bounds
    ends = []
    for side in (-1.0, 1.0):
        size = abs(_end(fitter, fit, index, side * spread, inflation) - best)
        if known and size < spread <= NEARBY * size:
            size = spread
        if _moment(fit.hypothesis, key):
            size = _further(fitter, fit, index, side, size, inflation)
        at = min(max(best + side * size, low), high)
        ends.append(free.value(at) if math.isfinite(at) else (free.lower if side < 0.0 else free.upper))
    return min(ends), max(ends)


def _end(fitter: Fitter, fit: Fit, index: int, step: float, inflation: float) -> float:
    """The z at which the profile reaches its level, looked for from one linear step away."""
    low, high = fit.hypothesis.free[index].bounds
    best = float(fit.z[index])
    inner, outer = 0.0, math.inf  # steps known to lie inside and outside
    for _ in range(TRIES):
        at = min(max(best + step, low), high)
        rise = _rise(fitter, fit, index, at) / inflation
        if at != best + step and rise < LEVEL_95:
            return at  # the bound itself is inside
        if abs(rise - LEVEL_95) < CLOSE * LEVEL_95:
            return at
        size = abs(at - best)
        if rise < LEVEL_95:
            inner = max(inner, size)
        else:
            outer = min(outer, size)
        wanted = size * min(max(math.sqrt(LEVEL_95 / max(rise, 1e-3)), 0.3), STRIDE)
        if not inner < wanted < outer:
            wanted = 0.5 * (inner + outer) if math.isfinite(outer) else 2.0 * inner
        step = math.copysign(wanted, step)
    if math.isinf(outer) and rise < FLAT * LEVEL_95:
        return low if step < 0.0 else high
    return min(max(best + step, low), high)


def _moment(made: Hypothesis, key: str) -> bool:
    return any(p.moment and s.key(p.name) == key for s in made.sites for p in s.effect.parameters)


def _further(fitter: Fitter, fit: Fit, index: int, side: float, size: float, inflation: float) -> float:
    """The outermost z off the best one, to a side, at which the profile is below its level; `size` at least."""
    free, best = fit.hypothesis.free[index], float(fit.z[index])
    low, high = free.bounds
    longest = max(t.end - t.start for t in fitter.trials)
    step = abs(free.z(free.value(best) + longest / MOMENT) - best)
    end, outside = size, 0
    for k in range(1, FURTHER + 1):
        at = best + side * (size + k * step)
        if not low <= at <= high or outside == OUTSIDE:
            break
        if _rise(fitter, fit, index, at) / inflation < LEVEL_95:
            end, outside = abs(at - best), 0
        else:
            outside += 1
    return end


def _rise(fitter: Fitter, fit: Fit, index: int, at: float) -> float:
    """Rise of the cost with one parameter held at z = `at`; infinite where that cannot be simulated."""
    held = _held(fit.hypothesis, index, at)
    values = {**fit.values(), held.free[index].key: held.free[index].lower}
    try:
        found = fitter.fit(
            held,
            warm=values,
            initials=fit.initials(),
            max_iterations=6,
            robust=False,
            rows=known_rows(fitter, held, fit),
            loose=True,
        )
    except SimulationError:
        return math.inf
    return max(found.cost - fit.cost, 0.0)


def _held(made: Hypothesis, index: int, at: float) -> Hypothesis:
    value = made.free[index].value(at)
    free = [*made.free]
    free[index] = replace(free[index], lower=value, upper=value)
    return replace(made, free=tuple(free))
