"""Output-error fit of a hypothesis to all trials: block Gauss-Newton with the trials' own initial values eliminated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.fitting.descent import Descent, Manner
from spacerobot.diagnosis.fitting.fitted import Fit, State, TrialFit
from spacerobot.diagnosis.fitting.linearised import Linearised
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Hypothesis
from spacerobot.support.errors import SimulationError

ROBUST_ABOVE = 1.3
"""chi-squared per sample of a start above which the robust cost is lowered first."""

RESCUES = 3
RESCUE_GAIN = 5.0
"""How often trials are put back to their free approach, and by how much chi-squared must fall for it."""

BUDGET = 6
"""Simulations of each trial that a fit may spend per iteration it is allowed; beyond, it ends where it stands."""

SAY = 10.0
"""Independent things that a channel of a trial says of what it does not fit yet: beliefs are held by as much first."""


class Fitter(Linearised):
    """Fits hypotheses to the trials of one model.

    Args:
        model: of the trials.
        trials: to fit.
        threads: that simulate trials.
        hasty: whether it takes less care of what fits badly.
        careful: whether it goes on to the last digit, with derivatives by differences to both sides.
    """

    def __init__(
        self,
        model: Machine,
        trials: Sequence[TrialData],
        *,
        threads: int = 1,
        hasty: bool = False,
        careful: bool = False,
    ) -> None:
        super().__init__(model, trials, threads=threads)
        self._manner = Manner(hasty=hasty, careful=careful)
        self._rows_of: tuple[object, dict[str, np.ndarray]] | None = None
        self.unstated: dict[str, float] | None = None

    def fit(
        self,
        hypothesis: Hypothesis,
        *,
        warm: Mapping[str, float] | None = None,
        initials: Mapping[str, np.ndarray] | None = None,
        max_iterations: int = 40,
        hopeless: float = np.inf,
        robust: bool = True,
        rows: Mapping[str, np.ndarray] | None = None,
        loose: bool = False,
        eager: bool = False,
        one_sided: bool = False,
    ) -> Fit:
        """The best parameters near a start.

        While the misfit is large, a robust form of the cost is lowered first: channels of trials that do not fit
        yet weigh less, so that they cannot drag the values that others determine.

        Args:
            hypothesis: what to fit; its free parameters' centres are the start.
            warm: start values by key instead.
            initials: start of the trials' initial values.
            max_iterations: of Gauss-Newton, over all stages.
            hopeless: cost above which a fit that hardly falls any more is given up.
            robust: whether the robust cost may come first; not where the start is a finished fit.
            rows: derivatives at the start, by trial, that are known already but for the effects' columns.
            loose: whether it may end on old derivatives; it then does not count as converged.
            eager: whether it may be given up on what a step promises; needs `rows`.
            one_sided: whether it has converged as far as differences to one side can tell.

        Raises:
            SimulationError: the start cannot be simulated.
        """
        spread = sum(len(s.effect.parameters) for s in hypothesis.sites if s.effect.learned)  # each a column to take
        self.left = (BUDGET + spread) * len(self.trials) * max_iterations
        state = self.state(hypothesis, hypothesis.start(warm), initials or self.guess())
        if state is None:
            raise SimulationError("the start of a fit cannot be simulated")
        used = 0
        if robust and state.chi2() > ROBUST_ABOVE * state.samples:
            for firm in (self._firmness(state), 1.0):
                manner = replace(self._manner, robust=True, firm=firm)
                ending = Descent(self, hypothesis, state, manner).run(max_iterations // 3)
                state, used = ending.state, used + ending.iterations
        eager = eager and rows is not None
        manner = replace(self._manner, hopeless=hopeless, loose=loose, eager=eager, one_sided=one_sided)
        converged, given_up, system = False, False, None
        for _ in range(RESCUES):
            if rows is None:
                state, _ = self.rescue(hypothesis, state)
            ending = Descent(self, hypothesis, state, manner, rows).run(max_iterations - used)
            state, converged, given_up = ending.state, ending.converged, ending.given_up
            system = ending.system or system
            rows, manner = None, replace(manner, eager=False)
            used += ending.iterations
            if given_up:
                break
            state, rescued = self.rescue(hypothesis, state)
            if not rescued or used >= max_iterations:
                break
        prior = hypothesis.precision
        covariance = None if system is None else system.covariance()
        trials = {
            t.id: TrialFit(state.own[t.id], np.where(state.keep[t.id], state.raw[t.id], 0.0)) for t in self.trials
        }
        return Fit(
            hypothesis,
            state.z,
            trials,
            state.chi2(),
            float(state.z @ prior @ state.z),
            state.samples,
            covariance,
            converged,
            used,
            given_up,
        )

    def rescue(self, hypothesis: Hypothesis, state: State) -> tuple[State, bool]:
        """Puts trials whose start has wandered back to what their free approach says, where that fits better.

        The pattern of bounces depends on the moment of touch, so a trial's cost has many minima in its start; and in
        the offset of a clock of its own, which is looked for from either start.
        """

        def one(trial: TrialData) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
            own, raw, keep = state.own[trial.id], state.raw[trial.id], state.keep[trial.id]
            if not own.size:
                return None
            mechanism = self.model.trial_mechanism(hypothesis, state.z, trial)
            found, least = None, np.square(raw[keep]).sum() - RESCUE_GAIN
            for start in (self.model.approach_start(trial, own, raw), own):
                try:
                    initial = self.model.in_step(mechanism, trial, start)
                    if np.array_equal(initial, own):
                        continue
                    new, new_keep = self.residual(hypothesis, state.z, trial, initial)
                except SimulationError:
                    continue
                cost = np.square(new[new_keep]).sum()
                if cost < least:
                    found, least = (initial, new, new_keep), cost
            return found

        found = {k: v for k, v in self.by_trial(one).items() if v is not None}
        if not found:
            return state, False
        own = {**state.own, **{k: v[0] for k, v in found.items()}}
        raw = {**state.raw, **{k: v[1] for k, v in found.items()}}
        keep = {**state.keep, **{k: v[2] for k, v in found.items()}}
        return State(state.z, own, raw, keep), True

    def _firmness(self, state: State) -> float:
        """By what readings that do not fit outweigh what is believed: they go on from sample to sample."""
        groups = sum(len(b.channels) for t in self.trials for b in t.blocks)
        return max(state.samples / (SAY * groups), 1.0)

    def rows_at(self, fit: Fit) -> dict[str, np.ndarray]:
        """Derivatives at a finished fit, by trial; kept, because many fits begin at the same one."""
        key = (fit.hypothesis.label, fit.z.tobytes())
        if self._rows_of is None or self._rows_of[0] != key:
            state = self.state(fit.hypothesis, fit.z, fit.initials())
            if state is None:
                raise SimulationError("a finished fit can no longer be simulated")
            self._rows_of = key, self.jacobians(fit.hypothesis, state, {})
        return self._rows_of[1]
