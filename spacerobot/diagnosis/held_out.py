"""Held-out conditions: fit without them, predict them, and compare before with after."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.data import TrialData
from spacerobot.diagnosis.fit import Fitter
from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.hypothesis import Hypothesis
from spacerobot.diagnosis.pool import Pool
from spacerobot.diagnosis.workshop import Task, Workshop
from spacerobot.support.errors import SimulationError

MOST_FOLDS = 6


@dataclass(frozen=True, eq=False)
class HeldOut:
    """How well a hypothesis predicts what it was not fitted to.

    Attributes:
        scheme: "leave one condition out" or "leave one trial out".
        residuals: weighted residual by trial, each predicted without its own fold; shape (S,).
        chi2: sum of their squares, by trial.
        samples: number of samples.
    """

    scheme: str
    residuals: Mapping[str, np.ndarray]
    chi2: Mapping[str, float]
    samples: int

    @property
    def total(self) -> float:
        """chi-squared over all held-out trials."""
        return float(sum(self.chi2.values()))


def folds(trials: tuple[TrialData, ...]) -> tuple[str, list[tuple[str, ...]]]:
    """Sets of trials to leave out in turn: conditions, or trials where there is one condition only."""
    conditions: dict[str, list[str]] = {}
    for trial in trials:
        conditions.setdefault(trial.condition, []).append(trial.id)
    if len(conditions) > 1:
        return "leave one condition out", [tuple(ids) for ids in conditions.values()]
    ids = [t.id for t in trials]
    return "leave one trial out", [tuple(ids[k::MOST_FOLDS]) for k in range(min(MOST_FOLDS, len(ids)))]


def hold_out(pool: Pool, fits: Mapping[str, Fit]) -> dict[str, HeldOut]:
    """Predict every fold with each fit's hypothesis, refitted without it.

    A held-out trial's own start, and its condition's own scatter, are found from the trial itself, as in use: they
    are not what is tested. Everything else comes from the other trials.

    Args:
        pool: runs the fits.
        fits: finished fits by name.
    """
    workshop = pool.workshop
    scheme, sets = folds(workshop.trials)
    if len(sets) < 2:
        return {}
    tasks, names = [], {}
    for name, fit in fits.items():
        for out in sets:
            task = Task(
                fit.hypothesis.label,
                {},
                near=_without(fit, out),
                max_iterations=8,
                without=out,
                loose=True,
                freed=fit.hypothesis.freed,
            )
            names[id(task)] = name
            tasks.append(task)
    found: dict[str, dict[str, np.ndarray]] = {name: {} for name in fits}
    for task, trained in pool.run(tasks):
        if trained is not None:
            found[names[id(task)]].update(_predict(workshop, trained, task.without))
    out_of = {}
    for name, residuals in found.items():
        chi2 = {k: float(r @ r) for k, r in residuals.items()}
        out_of[name] = HeldOut(scheme, residuals, chi2, int(sum((r != 0.0).sum() for r in residuals.values())))
    return out_of


def _without(fit: Fit, out: tuple[str, ...]) -> Fit:
    return replace(fit, trials={k: v for k, v in fit.trials.items() if k not in out})


def frozen(made: Hypothesis, values: Mapping[str, float], free: tuple[str, ...]) -> Hypothesis:
    """The hypothesis with all but some parameters held at given values."""
    held = tuple(
        f if f.key in free else replace(f, lower=values[f.key], upper=values[f.key], prior=False) for f in made.free
    )
    return replace(made, free=held)


def _predict(workshop: Workshop, trained: Fit, out: tuple[str, ...]) -> dict[str, np.ndarray]:
    trials = [t for t in workshop.trials if t.id in out]
    conditions = {t.condition for t in trials}
    free = tuple(f.key for f in trained.hypothesis.free if f.kind == "scatter" and f.key.split("|", 1)[0] in conditions)
    made = frozen(trained.hypothesis, trained.values(), free)
    fitter = Fitter(workshop.model, trials)
    try:
        fit = fitter.fit(made, warm=trained.values(), max_iterations=8, robust=False)
    except SimulationError:
        return {}
    return {k: t.residual for k, t in fit.trials.items()}
