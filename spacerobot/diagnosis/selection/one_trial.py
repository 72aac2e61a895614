"""What acts in one trial alone: a knock that nobody meant, sought in every trial."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.screen import FAINT
from spacerobot.diagnosis.fitting.starts import moments
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import EARN, PENALTY
from spacerobot.diagnosis.terms.hypothesis import Believed, Site, hypothesis
from spacerobot.support.errors import SimulationError

SHARE = 0.6
"""Part of all that is left over, beyond the level of most trials, that one trial must hold."""

CHANCE = 2.0
"""Standard errors of what is left over that noise may leave."""

TRIED = 3
"""Starts that are fitted."""


@dataclass(frozen=True, eq=False)
class Seen:
    """A trial as a fit predicts it.

    Attributes:
        trial: its readings.
        initial: its start, shape (N,).
        residual: weighted, shape (K,), of the samples that count.
        keep: which do, shape (S,).
        own: orthonormal columns of what its start explains, and of the values that it alone has (a target that is in
            no other trial) within what is stated of them, shape (K + V, N + V): a row for each such value.
    """

    trial: TrialData
    initial: np.ndarray
    residual: np.ndarray
    keep: np.ndarray
    own: np.ndarray


def seen(fitter: Fitter, near: Fit) -> list[Seen]:
    """All trials that can be simulated at a fit."""
    found, rows = [], fitter.rows_at(near)
    for trial in fitter.trials:
        initial = near.trials[trial.id].initial
        try:
            residual, keep = fitter.residual(near.hypothesis, near.z, trial, initial)
        except SimulationError:
            continue
        free = near.hypothesis.free
        others = [t.overrides for t in fitter.trials if t is not trial]
        alone = {k for k, v in trial.overrides.items() if v not in [o.get(k) for o in others]}
        stated = [g for g, f in enumerate(free) if f.kind == "believed" and f.key in alone]
        columns = rows[trial.id][keep][:, [*stated, *range(len(free), rows[trial.id].shape[1])]]
        known = np.zeros((len(stated), columns.shape[1]))
        known[:, : len(stated)] = np.diag(np.sqrt([free[g].prior for g in stated]))
        own, _ = np.linalg.qr(np.vstack([columns, known]))
        found.append(Seen(trial, initial, residual[keep], keep, own))
    return found


def knocks(fitter: Fitter, believed: Believed, near: Fit, sites: Sequence[Site]) -> list[Task]:
    """Fits to make: momentary effects in one trial alone, in those trials and from those moments that promise most.

    Args:
        fitter: of all trials.
        believed: what the study says.
        near: a fit without them.
        sites: all that may be missing.
    """
    momentary = [s for s in sites if s.effect.once and s.label not in near.hypothesis.label]
    trials = seen(fitter, near) if momentary and len(fitter.trials) > 2 else []
    left = SHARE * left_over(trials)
    tasks = []
    for site in momentary:
        strength = site.key(site.effect.parameters[0].name)
        bar = max(left, EARN + PENALTY * (len(site.effect.parameters) + 1))
        promised: list[tuple[float, str, dict[str, float]]] = []
        for one in trials:
            alone = Site(site.effect, site.where, (one.trial.id,))
            for moment in moments(site, [one.trial]):
                start = {**moment, strength: FAINT * moment[strength]}
                gain, amplitude = promise(fitter, believed, near, alone, start, one)
                if gain > bar:
                    start[strength] *= float(np.clip(amplitude, -1e3, 1e3))
                    promised.append((gain, one.trial.id, start))
        promised.sort(key=lambda p: -p[0])
        label = tuple(sorted((*near.hypothesis.label, site.label)))
        for _, trial, start in promised[:TRIED]:
            tasks.append(Task(label, start, near=near, max_iterations=30, only=((site.label, (trial,)),)))
    return tasks


def left_over(trials: Sequence[Seen]) -> float:
    """chi-squared beyond the level of most trials, and beyond what noise may leave of it."""
    counts = np.array([max(np.count_nonzero(t.residual), 1) for t in trials])
    squares = np.array([float(t.residual @ t.residual) for t in trials])
    if not counts.size:
        return 0.0
    usual = float(np.median(squares / counts))
    return float(squares.sum() - usual * counts.sum() - CHANCE * usual * np.sqrt(2.0 * counts.sum()))


def promise(
    fitter: Fitter, believed: Believed, near: Fit, site: Site, start: Mapping[str, float], one: Seen
) -> tuple[float, float]:
    """By how much chi-squared of the trial would fall, and at which multiple of the start's strength."""
    made = hypothesis(believed, (*near.hypothesis.sites, site), start)
    try:
        moved, _ = fitter.residual(made, made.start({**near.values(), **start}), one.trial, one.initial)
    except SimulationError:
        return 0.0, 0.0
    beside = (0, one.own.shape[0] - one.residual.size)
    column = np.pad(moved[one.keep] - one.residual, beside)
    column = column - one.own @ (one.own.T @ column)
    norm = float(column @ column)
    if norm < 1e-12:
        return 0.0, 0.0
    amplitude = -float(column @ np.pad(one.residual, beside)) / norm
    return amplitude**2 * norm, amplitude
