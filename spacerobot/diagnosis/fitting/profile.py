"""Intervals by profile likelihood: a parameter is held further and further from its best value, all else refitted.

Contact makes the cost curved, so that the curvature at the best fit alone understates or overstates an interval.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.starts import known_rows
from spacerobot.diagnosis.terms.hypothesis import Hypothesis
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

BEYOND, BEHIND = 1.5, 2
"""Of all other values: each step of a search further out goes so many times as far as the last, the first from the end
(the profile's or the curvature's, whichever is further); it ends after so many outside the interval in a row, or TRIES.
Where the curvature has foretold the end, the cost is a parabola and nobody looks further."""

CLOSE = 0.1
"""Share of the level within which an end counts as met."""


@dataclass(frozen=True, eq=False)
class Profile:
    """One parameter's profile.

    Attributes:
        ends: lower and upper end of the 95 % interval, physical.
        lowest: the refit of least cost that was met on the way, the parameter held; it may cost less than the fit.
    """

    ends: tuple[float, float]
    lowest: Fit | None


def profile_interval(fitter: Fitter, fit: Fit, key: str, inflation: float) -> tuple[float, float]:
    """The 95 % interval alone; see `profile`."""
    return profile(fitter, fit, key, inflation).ends


def profile(fitter: Fitter, fit: Fit, key: str, inflation: float) -> Profile:
    """A parameter's profile, and its 95 % interval: values to which the cost, all else refitted, rises by too little.

    Too little is 3.84 times `inflation`, which widens the interval where noise is larger or more coloured than stated,
    and where the effect's law only stands for a richer one (`intervals.py`). Contacts make walls in the cost: beyond
    each end it is looked further out for values that fit again.

    Args:
        fitter: of the trials the fit was made to.
        fit: the best fit.
        key: of the free parameter.
        inflation: rise of the cost that counts as one.

    Returns:
        with ends at a bound of the parameter where the cost does not rise before it.
    """
    return _Profiler(fitter, fit, fit.hypothesis.keys.index(key), inflation).profile()


class _Profiler:
    """Refits with one parameter held, of which the cheapest is kept in mind."""

    def __init__(self, fitter: Fitter, fit: Fit, index: int, inflation: float) -> None:
        self.fitter, self.fit, self.index, self.inflation = fitter, fit, index, inflation
        self.free, self.best = fit.hypothesis.free[index], float(fit.z[index])
        self.low, self.high = self.free.bounds
        self.lowest: Fit | None = None

    def profile(self) -> Profile:
        """Both ends."""
        covariance = self.fit.covariance
        variance = 0.0 if covariance is None else float(covariance[self.index, self.index]) * self.inflation * LEVEL_95
        known = 0.0 < variance < 1e6
        spread = math.sqrt(variance) if known else 1.0
        ends = []
        for side in (-1.0, 1.0):
            size = abs(self._end(side * spread) - self.best)
            foretold = known and math.isclose(size, spread, rel_tol=1e-6)
            # a curvature much wider than the profile says that this minimum is one of several between walls
            reach = max(size, spread) if known else size
            if known and size < spread <= NEARBY * size:
                size = spread
            if _moment(self.fit.hypothesis, self.free.key):
                size = self._further(side, size, [size + k * self._moment_step for k in range(1, FURTHER + 1)], OUTSIDE)
            elif not foretold:
                size = self._further(side, size, [reach * BEYOND**k for k in range(1, TRIES + 1)], BEHIND)
            at = self._within(self.best + side * size)
            end = self.free.value(at) if math.isfinite(at) else (self.free.lower if side < 0.0 else self.free.upper)
            ends.append(end)
        return Profile((min(ends), max(ends)), self.lowest)

    def _end(self, step: float) -> float:
        """The z at which the profile reaches its level, looked for from one linear step away."""
        inner, outer = 0.0, math.inf  # steps known to lie inside and outside
        for _ in range(TRIES):
            at = self._within(self.best + step)
            rise = self._rise(at)
            if at != self.best + step and rise < LEVEL_95:
                return at  # the bound itself is inside
            if abs(rise - LEVEL_95) < CLOSE * LEVEL_95:
                return at
            size = abs(at - self.best)
            if rise < LEVEL_95:
                inner = max(inner, size)
            else:
                outer = min(outer, size)
            wanted = size * min(max(math.sqrt(LEVEL_95 / max(rise, 1e-3)), 0.3), STRIDE)
            if not inner < wanted < outer:
                wanted = 0.5 * (inner + outer) if math.isfinite(outer) else 2.0 * inner
            step = math.copysign(wanted, step)
        if math.isinf(outer) and rise < FLAT * LEVEL_95:
            return self.low if step < 0.0 else self.high
        return self._within(self.best + step)

    def _further(self, side: float, size: float, places: Sequence[float], most: int) -> float:
        """How far off the best z, to a side, the profile is below its level still; `size` at least.

        Args:
            side: -1 or 1.
            size: where its level was met.
            places: distances further out to look at, in turn.
            most: so many in a row outside end the search.
        """
        end, outside = size, 0
        for place in places:
            at = self.best + side * place
            if not self.low <= at <= self.high or outside == most:
                break
            if self._rise(at) < LEVEL_95:
                end, outside = place, 0
            else:
                outside += 1
        return end

    @property
    def _moment_step(self) -> float:
        longest = max(t.end - t.start for t in self.fitter.trials)
        return abs(self.free.z(self.free.value(self.best) + longest / MOMENT) - self.best)

    def _within(self, z: float) -> float:
        return min(max(z, self.low), self.high)

    def _rise(self, at: float) -> float:
        """Rise of the cost with the parameter held at z = `at`, over what counts as one; infinite where that cannot be
        simulated, negative where it leads to a better minimum.
        """
        held = _held(self.fit.hypothesis, self.index, at)
        values = {**self.fit.values(), held.free[self.index].key: held.free[self.index].lower}
        try:
            found = self.fitter.fit(
                held,
                warm=values,
                initials=self.fit.initials(),
                max_iterations=6,
                robust=False,
                rows=known_rows(self.fitter, held, self.fit),
                loose=True,
            )
        except SimulationError:
            return math.inf
        if self.lowest is None or found.cost < self.lowest.cost:
            self.lowest = found
        return (found.cost - self.fit.cost) / self.inflation


def _moment(made: Hypothesis, key: str) -> bool:
    return any(p.moment and s.key(p.name) == key for s in made.sites for p in s.effect.parameters)


def _held(made: Hypothesis, index: int, at: float) -> Hypothesis:
    value = made.free[index].value(at)
    free = [*made.free]
    free[index] = replace(free[index], lower=value, upper=value)
    return replace(made, free=tuple(free))
