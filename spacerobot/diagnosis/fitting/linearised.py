"""What a fit knows of its trials near a point: their residuals, and how these move with whatever is free."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from spacerobot.diagnosis.fitting.fitted import State
from spacerobot.diagnosis.fitting.normal_equations import Normal
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.rig_trials import counted
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Hypothesis
from spacerobot.support.errors import SimulationError

DIFFERENCE = 0.02
"""Finite-difference step in units of a parameter's scale."""

OF_CURVES = 1e-3
"""And of a learned curve's coefficients, whose scale is the largest force at their port: over a fiftieth of that a body
that nothing holds goes another way altogether, and descents crept along slopes that were none.
"""

BEYOND = 1e150
"""A residual that no square can be taken of."""


class Linearised:
    """Residuals of a model's trials and their derivatives.

    Args:
        model: of the trials.
        trials: to simulate.
        threads: that simulate trials.

    Attributes:
        left: simulations that may still be spent.
    """

    def __init__(self, model: Machine, trials: Sequence[TrialData], *, threads: int = 1) -> None:
        self.model = model
        self.trials = tuple(trials)
        self.left = 0
        self._pool = ThreadPoolExecutor(threads) if threads > 1 else None
        own = {t.id: model.nuisances(t) for t in trials}
        self._scales = {name: np.array([n.scale for n in some]) for name, some in own.items()}
        self._starts_by = {name: [max(DIFFERENCE, n.floor) for n in some] for name, some in own.items()}

    def by_trial(self, work: Callable[[TrialData], Any]) -> dict[str, Any]:
        """What a function makes of every trial, by their ids."""
        results = map(work, self.trials) if self._pool is None else self._pool.map(work, self.trials)
        return dict(zip((t.id for t in self.trials), results, strict=True))

    def residual(
        self, hypothesis: Hypothesis, z: np.ndarray, trial: TrialData, initial: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weighted residual of one trial, predicted minus measured, and which samples count, shape (S,) each.

        Raises:
            SimulationError: it cannot be simulated, or what is predicted is no finite number.
        """
        self.left -= 1
        mechanism = self.model.trial_mechanism(hypothesis, z, trial)
        prediction = self.model.predict(mechanism, trial, initial)
        parts = [((p - b.value) * b.weight).ravel() for p, b in zip(prediction.blocks, trial.blocks, strict=True)]
        whole = parts[0] if len(parts) == 1 else np.concatenate(parts)
        keep = counted(mechanism, trial, prediction)
        if not np.abs(whole[keep]).max(initial=0.0) < BEYOND:
            raise SimulationError(f"trial {trial.id}: the simulation runs away")
        return whole, keep

    def guess(self) -> dict[str, np.ndarray]:
        """First initial values of every trial, from its free approach."""
        return {t.id: np.array([n.guess for n in self.model.nuisances(t)]) for t in self.trials}

    def state(self, hypothesis: Hypothesis, z: np.ndarray, own: Mapping[str, np.ndarray]) -> State | None:
        """Residuals of all trials at these parameters, or None where they cannot be simulated."""
        try:
            rows = self.by_trial(lambda t: self.residual(hypothesis, z, t, own[t.id]))
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
            step = OF_CURVES if free.key in curves else DIFFERENCE
            step = step if z[g] + step <= high[g] else -step
            if z[g] + step < low[g]:
                continue

            def with_value(by: float, g: int = g) -> np.ndarray:
                return self.residual(hypothesis, _moved(z, g, by), trial, initial)[0]

            columns[:, g] = _slope(with_value, base, step, low[g] <= z[g] - step <= high[g], both)
        for n, scale in enumerate(scales if old is None else ()):
            added = self.added(trial, n)
            if added is not None:
                columns[:, z.size + n] = scale * added
                continue

            def with_start(by: float, n: int = n, scale: float = scale) -> np.ndarray:
                return self.residual(hypothesis, z, trial, _moved(initial, n, by * scale))[0]

            columns[:, z.size + n] = _slope(with_start, base, self._starts_by[trial.id][n], True, both)
        return columns

    def added(self, trial: TrialData, n: int) -> np.ndarray | None:
        """Derivative of a trial's residual by a value of its own that is only added to a channel, shape (S,)."""
        channel = self.model.nuisances(trial)[n].adds_to
        if not channel:
            return None
        rows = [w if c == channel else np.zeros_like(w) for b in trial.blocks for c, w in zip(b.channels, b.weight)]
        return np.concatenate(rows)

    def jacobians(
        self, hypothesis: Hypothesis, state: State, old: Mapping[str, np.ndarray], both: bool = False
    ) -> dict[str, np.ndarray]:
        """Derivatives of all trials, by their ids, as `jacobian` takes them."""
        return self.by_trial(lambda t: self.jacobian(hypothesis, state, t, old.get(t.id), both))

    def corrected(self, rows: Mapping[str, np.ndarray], old: State, new: State) -> dict[str, np.ndarray]:
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

        pairs = list(self.by_trial(weighted).values())
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
