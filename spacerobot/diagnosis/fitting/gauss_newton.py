"""Output-error fit of a hypothesis to all trials: block Gauss-Newton with the trials' own initial values eliminated."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit, State, TrialFit
from spacerobot.diagnosis.fitting.normal_equations import Normal
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.wrist_rig import counted
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Hypothesis
from spacerobot.support.errors import SimulationError

DIFFERENCE = 0.02
"""Finite-difference step in units of a parameter's scale."""

ROBUST_ABOVE = 1.3
"""chi-squared per sample of a start above which the robust cost is lowered first."""

RESCUES = 3
RESCUE_GAIN = 5.0
"""How often trials are put back to their free approach, and by how much chi-squared must fall for it."""

BUDGET = 6
"""Simulations of each trial that a fit may spend per iteration it is allowed; beyond, it ends where it stands."""

LADDER = 10
"""Steps that are tried, each damped ten times as much as the one before; then again, trials' own values damped too."""

SAY = 10.0
"""Independent things that a channel of a trial says of what it does not fit yet: beliefs are held by as much first."""

FREE = 1e-9
"""Damping, as a share of the curvature, that is next to none: a fit has converged only when no more than so much holds
it where it is. Where tens of thousands of readings make the curvature, far more hides what a prior would move.
"""

REUSE = 5
"""How many steps may be taken on one set of derivatives, corrected by each step, while each keeps its promise."""

HOPE = 5.0
"""A fit that may be given up early is, when not even so many times what its next step promises would do."""

SETTLED = 0.05
WORTH = 1e-3
"""A fit has converged when a step lowers chi-squared by less than the first, or than this share of the misfit."""

BAD, WORTH_IF_BAD = 0.5, 1e-2
"""Misfit per sample above which a hasty fitter asks for no last digits, and the share of it that then counts."""


class Fitter:
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
        self.model = model
        self._hasty, self._careful = hasty, careful
        self.trials = tuple(trials)
        self._pool = ThreadPoolExecutor(threads) if threads > 1 else None
        self._left = 0
        self._rows_of: tuple[object, dict[str, np.ndarray]] | None = None
        self.unstated: dict[str, float] | None = None
        own = {t.id: model.nuisances(t) for t in trials}
        self._scales = {name: np.array([n.scale for n in some]) for name, some in own.items()}
        self._starts_by = {name: [max(DIFFERENCE, n.floor) for n in some] for name, some in own.items()}

    def _map(self, work: Callable[[TrialData], Any]) -> dict[str, Any]:
        results = map(work, self.trials) if self._pool is None else self._pool.map(work, self.trials)
        return dict(zip((t.id for t in self.trials), results, strict=True))

    def residual(
        self, hypothesis: Hypothesis, z: np.ndarray, trial: TrialData, initial: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weighted residual of one trial, predicted minus measured, and which samples count, shape (S,) each.

        Raises:
            SimulationError: it cannot be simulated, or what is predicted is no finite number.
        """
        self._left -= 1
        mechanism = self.model.trial_mechanism(hypothesis, z, trial)
        prediction = self.model.predict(mechanism, trial, initial)
        parts = [((p - b.value) * b.weight).ravel() for p, b in zip(prediction.blocks, trial.blocks, strict=True)]
        whole, keep = np.concatenate(parts), counted(mechanism, trial, prediction)
        shown = whole[keep]
        if not np.isfinite(shown @ shown):
            raise SimulationError(f"trial {trial.id}: the simulation runs away")
        return whole, keep

    def guess(self) -> dict[str, np.ndarray]:
        """First initial values of every trial, from its free approach."""
        return {t.id: np.array([n.guess for n in self.model.nuisances(t)]) for t in self.trials}

    def state(self, hypothesis: Hypothesis, z: np.ndarray, own: Mapping[str, np.ndarray]) -> State | None:
        """Residuals of all trials at these parameters, or None where they cannot be simulated."""
        try:
            rows = self._map(lambda t: self.residual(hypothesis, z, t, own[t.id]))
        except SimulationError:
            return None
        return State(z, dict(own), {k: r[0] for k, r in rows.items()}, {k: r[1] for k, r in rows.items()})

    def jacobian(
        self,
        hypothesis: Hypothesis,
        state: State,
        trial: TrialData,
        old: np.ndarray | None = None,
        both: bool = False,
    ) -> np.ndarray:
        """Derivatives of one trial's residual, shape (S, G + N), by differences into the bounds.

        With `old` derivatives only the effects' columns are taken anew: theirs is the strongest curvature. A learned
        curve's are not: they are many, and a force is linear in them.
        """
        low, high = hypothesis.bounds()
        z, initial, base = state.z, state.own[trial.id], state.raw[trial.id]
        scales = self._scales[trial.id]
        columns = np.zeros((base.size, z.size + scales.size), order="F") if old is None else old.copy(order="F")
        idle = hypothesis.idle(trial.id)
        curves = {s.key(p.name) for s in hypothesis.sites if s.effect.learned for p in s.effect.parameters}
        for g, free in enumerate(hypothesis.free):
            if old is not None and (free.kind != "effect" or free.key in curves):
                continue
            if free.key in idle:
                continue
            if free.kind == "scatter" and not free.key.startswith(f"{trial.condition}|"):
                continue
            step = DIFFERENCE if z[g] + DIFFERENCE <= high[g] else -DIFFERENCE
            if z[g] + step < low[g]:
                continue

            def with_value(by: float, g: int = g) -> np.ndarray:
                return self.residual(hypothesis, _moved(z, g, by), trial, initial)[0]

            columns[:, g] = _slope(with_value, base, step, low[g] <= z[g] - step <= high[g], both)
        for n, scale in enumerate(scales if old is None else ()):

            def with_start(by: float, n: int = n, scale: float = scale) -> np.ndarray:
                return self.residual(hypothesis, z, trial, _moved(initial, n, by * scale))[0]

            columns[:, z.size + n] = _slope(with_start, base, self._starts_by[trial.id][n], True, both)
        return columns

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

        Raises:
            SimulationError: the start cannot be simulated.
        """
        spread = sum(len(s.effect.parameters) for s in hypothesis.sites if s.effect.learned)  # each a column to take
        self._left = (BUDGET + spread) * len(self.trials) * max_iterations
        state = self.state(hypothesis, hypothesis.start(warm), initials or self.guess())
        if state is None:
            raise SimulationError("the start of a fit cannot be simulated")
        used = 0
        if robust and state.chi2() > ROBUST_ABOVE * state.samples:
            for firm in (self._firmness(state), 1.0):
                state, more, _, _, _ = self._descend(hypothesis, state, True, max_iterations // 3, firm=firm)
                used += more
        given_up, system = False, None
        for _ in range(RESCUES):
            if rows is None:
                state, _ = self.rescue(hypothesis, state)
            state, iterations, converged, last, given_up = self._descend(
                hypothesis, state, False, max_iterations - used, hopeless, rows, loose, eager and rows is not None
            )
            system = last or system  # none where nothing was left to spend
            rows = None
            used += iterations
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

        The pattern of bounces depends on the moment of touch, so a trial's cost has many minima in its start.
        """

        def one(trial: TrialData) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
            raw, keep = state.raw[trial.id], state.keep[trial.id]
            initial = self.model.approach_start(trial, state.own[trial.id], raw)
            try:
                new, new_keep = self.residual(hypothesis, state.z, trial, initial)
            except SimulationError:
                return None
            better = np.square(new[new_keep]).sum() < np.square(raw[keep]).sum() - RESCUE_GAIN
            return (initial, new, new_keep) if better else None

        found = {k: v for k, v in self._map(one).items() if v is not None}
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

    def _descend(
        self,
        hypothesis: Hypothesis,
        state: State,
        robust: bool,
        max_iterations: int,
        hopeless: float = np.inf,
        known: Mapping[str, np.ndarray] | None = None,
        loose: bool = False,
        eager: bool = False,
        firm: float = 1.0,
    ) -> tuple[State, int, bool, Normal | None, bool]:
        """Where it ended, steps taken, whether it converged, its last normal equations, and whether it was given up."""
        low, high = hypothesis.bounds()
        prior = firm * hypothesis.precision
        damping, converged, iterations, age = 1e-4, False, 0, 0 if known is None else 1
        system = None
        rows: dict[str, np.ndarray] = dict(known or {})
        ended, both = False, self._careful
        lowest, idle = np.inf, 0
        while iterations < max_iterations and not (converged or ended) and self._left > 0:
            iterations += 1
            if age >= REUSE:
                rows, age = {}, 0
            rows = self._jacobians(hypothesis, state, rows, both)
            system = self.normal(state, rows, prior, robust)
            accepted = False
            misfit = abs(state.loss(self.trials, robust) - state.samples)
            bad = self._hasty and misfit > BAD * state.samples
            settled = SETTLED if self._careful else max(SETTLED, misfit * (WORTH_IF_BAD if bad else WORTH))
            first, freely = damping, False
            for tried in range(2 * LADDER):
                if tried == LADDER:  # every step was refused: it may be the trials' own values that lead nowhere
                    damping = first
                far, own_too = self.model.strides, tried >= LADDER
                dz, dn, promised = system.step(damping, state.z, low, high, far=far, own_too=own_too)
                if eager and state.chi2() + float(state.z @ prior @ state.z) - HOPE * promised > hopeless:
                    return state, iterations - 1, False, system, True
                if promised < settled and not (bad or freely) and damping > FREE:
                    freely, damping = True, FREE  # so little may be the damping's doing, along a narrow valley
                    continue
                if promised < settled or (freely and damping > first):
                    converged = age == 0
                    ended = loose
                    break
                new = self.state(hypothesis, np.clip(state.z + dz, low, high), self.own_moved(state, dn))
                if new is not None:
                    # both under the old masks, else a touch that moves would pay for itself
                    fall = state.loss(self.trials, robust) - new.loss(self.trials, robust, state.keep)
                    fall += float(state.z @ prior @ state.z - new.z @ prior @ new.z)
                    if fall > 0.0:
                        damping = max(damping * (0.2 if fall > 0.7 * promised else 1.0), FREE)
                        converged = fall < settled and age == 0 and (bad or freely or damping <= FREE)
                        ended = fall < settled and loose
                        age = age + 1 if fall > 0.6 * promised else REUSE
                        if age < REUSE:
                            rows = self._corrected(rows, state, new)
                        state, accepted = new, True
                        cost = state.loss(self.trials, robust) + float(state.z @ prior @ state.z)
                        lowest, idle = (cost, 0) if cost < lowest - settled else (lowest, idle + 1)
                        converged |= idle > REUSE  # to and fro, a touch on this side of a sample and on that
                        hope = state.chi2() + float(state.z @ prior @ state.z) - 10.0 * fall
                        if not robust and iterations >= 3 and hope > hopeless:
                            return state, iterations, False, system, False
                        break
                if age > 0:
                    break
                damping = max(10.0 * damping, 0.0 if freely else 1e-3)
            rough = both or robust or loose or bad or state.chi2() > hopeless
            if converged and not rough:
                converged, both, age = False, True, REUSE  # it stands as far as differences to one side can tell
            if not (accepted or converged or ended):
                if age == 0 and rough:
                    break
                both |= age == 0
                age = REUSE  # the step came from old derivatives: take new ones before giving up
        return state, iterations, converged, system, False

    def _jacobians(
        self, hypothesis: Hypothesis, state: State, old: Mapping[str, np.ndarray], both: bool = False
    ) -> dict[str, np.ndarray]:
        return self._map(lambda t: self.jacobian(hypothesis, state, t, old.get(t.id), both))

    def _corrected(self, rows: Mapping[str, np.ndarray], old: State, new: State) -> dict[str, np.ndarray]:
        """Derivatives that would have foretold the step just taken (Broyden 1965), by the least change."""
        out = {}
        for trial in self.trials:
            j = rows[trial.id]
            moved = (new.own[trial.id] - old.own[trial.id]) / self._scales[trial.id]
            step = np.concatenate([new.z - old.z, moved])
            weighted = step * np.einsum("sp,sp->p", j, j)
            bottom = float(step @ weighted)
            surprise = new.raw[trial.id] - old.raw[trial.id] - j @ step
            out[trial.id] = j + np.outer(weighted / bottom, surprise).T if bottom > 1e-12 else j
        return out

    def rows_at(self, fit: Fit) -> dict[str, np.ndarray]:
        """Derivatives at a finished fit, by trial; kept, because many fits begin at the same one."""
        key = (fit.hypothesis.label, fit.z.tobytes())
        if self._rows_of is None or self._rows_of[0] != key:
            state = self.state(fit.hypothesis, fit.z, fit.initials())
            if state is None:
                raise SimulationError("a finished fit can no longer be simulated")
            self._rows_of = key, self._jacobians(fit.hypothesis, state, {})
        return self._rows_of[1]

    def own_moved(self, state: State, steps: Sequence[np.ndarray]) -> dict[str, np.ndarray]:
        """The trials' own initial values after a step of each, in units of their scales."""
        return {t.id: state.own[t.id] + s * self._scales[t.id] for t, s in zip(self.trials, steps, strict=True)}

    def normal(self, state: State, rows: Mapping[str, np.ndarray], prior: np.ndarray, robust: bool = False) -> Normal:
        """Normal equations at a state, by these derivatives, under the prior's precision, shape (G, G)."""

        def weighted(trial: TrialData) -> tuple[np.ndarray, np.ndarray]:
            keep = state.keep[trial.id]
            jacobian, residual = np.compress(keep, rows[trial.id].T, axis=1).T, state.raw[trial.id][keep]
            if robust:
                weight = state.weights(trial)[keep]
                jacobian, residual = jacobian * weight[:, None], residual * weight
            return jacobian, residual

        pairs = list(self._map(weighted).values())
        return Normal.build([p[0] for p in pairs], [p[1] for p in pairs], state.z, prior)


def _moved(vector: np.ndarray, index: int, by: float) -> np.ndarray:
    out = vector.copy()
    out[index] += by
    return out


def _slope(shown: Callable[[float], np.ndarray], base: np.ndarray, step: float, either: bool, both: bool) -> np.ndarray:
    """Derivative of what is `base` at no step, by a difference to one side, or to both.

    Where one side cannot be simulated the other one must do, if it may; where neither can, nothing is known.
    """
    found: list[np.ndarray] = []
    for by in (step, -step) if either else (step,):
        if found and not both:
            break
        try:
            found.append((shown(by) - base) / by)
        except SimulationError:
            continue
    if len(found) == 2:
        return np.asarray(0.5 * (found[0] + found[1]))
    return found[0] if found else np.zeros_like(base)
