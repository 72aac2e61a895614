"""One descent: steps of Gauss-Newton from a state, each damped until it falls, on derivatives that are used again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.fitted import State
from spacerobot.diagnosis.fitting.linearised import Linearised
from spacerobot.diagnosis.fitting.normal_equations import Normal
from spacerobot.diagnosis.terms.hypothesis import Hypothesis

LADDER = 10
"""Steps that are tried, each damped ten times as much as the one before; then again, trials' own values damped too."""

FREE = 1e-9
"""Damping, as a share of the curvature, that is next to none: a fit has converged only when no more than so much holds
it where it is. Where tens of thousands of readings make the curvature, far more hides what a prior would move.
"""

REUSE = 5
"""How many steps may be taken on one set of derivatives, corrected by each step, while each keeps its promise."""

HOPE = 5.0
"""A fit that may be given up early is, when not even so many times what its next step promises would do."""

HOPE_OF_FALLS = 10.0
"""And one that has begun, when so many times what its last step brought would not."""

SETTLED = 0.05
WORTH = 1e-3
"""A fit has converged when a step lowers chi-squared by less than the first, or than this share of the misfit: of what
is left over beyond the noise. Where noise is taken for louder than it is, all that the readings say is below it.
"""

BAD, WORTH_IF_BAD = 0.5, 1e-2
"""Misfit per sample above which no fitter asks for differences to both sides, and a hasty one for no last digits; and
the share of it that then counts.
"""


@dataclass(frozen=True)
class Manner:
    """How a descent goes.

    Attributes:
        robust: whether the robust form of the cost is lowered.
        firm: by what the precision of what is believed is multiplied.
        hopeless: cost above which it is given up when it hardly falls any more.
        loose: whether it may end on old derivatives; it then does not count as converged.
        eager: whether it may be given up on what a step promises.
        hasty: whether it takes less care of what fits badly.
        careful: whether it goes on to the last digit, with derivatives by differences to both sides.
        one_sided: whether it has converged as far as differences to one side can tell.
    """

    robust: bool = False
    firm: float = 1.0
    hopeless: float = np.inf
    loose: bool = False
    eager: bool = False
    hasty: bool = False
    careful: bool = False
    one_sided: bool = False


@dataclass(frozen=True, eq=False)
class Ending:
    """Where a descent ended.

    Attributes:
        state: there.
        iterations: steps taken.
        converged: whether the last one was negligible.
        system: its last normal equations; None where nothing was left to spend.
        given_up: whether it ended on what a step promised.
    """

    state: State
    iterations: int
    converged: bool = False
    system: Normal | None = None
    given_up: bool = False


class Descent:
    """A descent under way.

    Args:
        near: residuals and derivatives of the trials.
        hypothesis: what is fitted.
        state: where it begins.
        manner: how it goes.
        known: derivatives there, by trial, that are known already but for the effects' columns.
    """

    def __init__(
        self,
        near: Linearised,
        hypothesis: Hypothesis,
        state: State,
        manner: Manner,
        known: Mapping[str, np.ndarray] | None = None,
    ) -> None:
        self.near, self.hypothesis, self.state, self.manner = near, hypothesis, state, manner
        self.low, self.high = hypothesis.bounds()
        self.prior = manner.firm * hypothesis.precision
        self.system: Normal | None = None
        self.rows: dict[str, np.ndarray] = dict(known or {})
        self.age = 0 if known is None else 1  # steps taken on these derivatives
        self.both = manner.careful  # whether derivatives are differences to both sides
        self.damping = 1e-4
        self.fall = 0.0  # of the cost by the last step; none where no step was taken
        self.lowest, self.idle = np.inf, 0
        self.converged = self.ended = False

    def run(self, most: int) -> Ending:
        """Go down, by so many steps at most."""
        iterations = 0
        while iterations < most and not (self.converged or self.ended) and self.near.left > 0:
            iterations += 1
            if self.age >= REUSE:
                self.rows, self.age = {}, 0
            self.rows = self.near.jacobians(self.hypothesis, self.state, self.rows, self.both)
            system = self.system = self.near.normal(self.state, self.rows, self.prior, self.manner.robust)
            misfit = max(self.state.loss(self.near.trials, self.manner.robust) - self.state.samples, 0.0)
            off = misfit > BAD * self.state.samples
            bad = self.manner.hasty and off
            settled = SETTLED if self.manner.careful else max(SETTLED, misfit * (WORTH_IF_BAD if bad else WORTH))
            if self._gives_up(system, settled, bad):
                return Ending(self.state, iterations - 1, system=system, given_up=True)
            if self._hopeless(iterations):
                return Ending(self.state, iterations, system=system)
            if not self._goes_on(off):
                break
        return Ending(self.state, iterations, self.converged, self.system)

    def _cost(self) -> float:
        """chi-squared plus prior, where it stands."""
        return self.state.chi2() + float(self.state.z @ self.prior @ self.state.z)

    def _gives_up(self, system: Normal, settled: float, bad: bool) -> bool:
        """Try steps until one falls, or none is worth it; whether what the first promises is not enough."""
        self.fall = 0.0
        first, freely = self.damping, False
        for tried in range(2 * LADDER):
            if tried == LADDER:  # every step was refused: it may be the trials' own values that lead nowhere
                self.damping = first
            far, own_too = self.near.model.strides, tried >= LADDER
            dz, dn, promised = system.step(self.damping, self.state.z, self.low, self.high, far=far, own_too=own_too)
            if self.manner.eager and self._cost() - HOPE * promised > self.manner.hopeless:
                return True
            if promised < settled and not (bad or freely) and self.damping > FREE:
                freely, self.damping = True, FREE  # so little may be the damping's doing, along a narrow valley
                continue
            if promised < settled or (freely and self.damping > first):
                self.converged = self.age == 0
                self.ended = self.manner.loose
                break
            new = self.near.state(
                self.hypothesis, np.clip(self.state.z + dz, self.low, self.high), self.near.own_moved(self.state, dn)
            )
            fall = -np.inf if new is None else self._fall(new)
            if new is not None and fall > 0.0:
                self._accept(new, fall, promised, settled, bad or freely)
                break
            if self.age > 0:
                break
            self.damping = max(10.0 * self.damping, 0.0 if freely else 1e-3)
        return False

    def _fall(self, new: State) -> float:
        """Of the cost, both under the old masks, else a touch that moves would pay for itself."""
        old, trials, robust = self.state, self.near.trials, self.manner.robust
        fall = old.loss(trials, robust) - new.loss(trials, robust, old.keep)
        return fall + float(old.z @ self.prior @ old.z - new.z @ self.prior @ new.z)

    def _accept(self, new: State, fall: float, promised: float, settled: float, free: bool) -> None:
        """Stand there; `free`: so small a fall is not the damping's doing."""
        self.damping = max(self.damping * (0.2 if fall > 0.7 * promised else 1.0), FREE)
        self.converged = fall < settled and self.age == 0 and (free or self.damping <= FREE)
        self.ended = fall < settled and self.manner.loose
        self.age = self.age + 1 if fall > 0.6 * promised else REUSE
        if self.age < REUSE:
            self.rows = self.near.corrected(self.rows, self.state, new)
        self.state, self.fall = new, fall
        cost = new.loss(self.near.trials, self.manner.robust) + float(new.z @ self.prior @ new.z)
        self.lowest, self.idle = (cost, 0) if cost < self.lowest - settled else (self.lowest, self.idle + 1)
        self.converged |= self.idle > REUSE  # to and fro, a touch on this side of a sample and on that

    def _hopeless(self, iterations: int) -> bool:
        if self.fall == 0.0 or self.manner.robust or iterations < 3:
            return False
        return self._cost() - HOPE_OF_FALLS * self.fall > self.manner.hopeless

    def _goes_on(self, off: bool) -> bool:
        """Whether another step is to be tried: where the last settled on rough derivatives, or was refused on old ones,
        on better ones. `off`: what is left is not at the level of the noise, and the last digit of it says nothing.
        """
        rough = self.both or self.manner.robust or self.manner.loose
        rough = rough or self.manner.one_sided or self.state.chi2() > self.manner.hopeless
        if self.converged and not (rough or off):
            # it stands as far as differences to one side can tell
            self.converged, self.both, self.age = False, True, REUSE
        if not (self.fall > 0.0 or self.converged or self.ended):
            if self.age == 0 and (rough or (off and self.manner.hasty)):
                return False
            self.both |= self.age == 0
            self.age = REUSE  # the step came from old derivatives: take new ones before giving up
        return True
