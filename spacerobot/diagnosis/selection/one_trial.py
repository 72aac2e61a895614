"""What acts in one trial alone: a knock that nobody meant, sought in the trial that fits far worse than the rest."""

from __future__ import annotations

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.screen import FAINT
from spacerobot.diagnosis.fitting.starts import moments
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed, Site, hypothesis
from spacerobot.support.errors import SimulationError

SHARE = 0.6
"""Part of all that is left over, beyond what the other trials leave, that the one trial must hold."""

STANDS_OUT, CHANCE = 4.0, 2.0
"""Excess of the trial's chi-squared in its standard errors, and how much of it any trial may have by chance."""

TRIED = 3
"""Starts that are fitted."""


def odd_one_out(fit: Fit, trials: tuple[TrialData, ...]) -> TrialData | None:
    """The trial that fits far worse than all others, if there is one such."""
    level, counts = {}, {}
    for trial in trials:
        count = max(int((fit.trials[trial.id].residual != 0.0).sum()), 1)
        level[trial.id] = float(np.square(fit.trials[trial.id].residual).sum()) / count
        counts[trial.id] = count
    usual = float(np.median(list(level.values())))
    error = {t: usual * np.sqrt(2.0 * counts[t]) for t in level}
    over = {t: (level[t] - usual) * counts[t] - CHANCE * error[t] for t in level}
    total = sum(max(v, 0.0) for v in over.values())
    worst = max(over, key=lambda t: over[t])
    significant = over[worst] > (STANDS_OUT - CHANCE) * error[worst]
    if len(trials) < 3 or not significant or over[worst] < SHARE * total:
        return None
    return next(t for t in trials if t.id == worst)


def knocks(fitter: Fitter, believed: Believed, near: Fit, sites: tuple[Site, ...]) -> list[Task]:
    """Fits to make: momentary effects in the odd trial alone, from the moments that promise most.

    Args:
        fitter: of all trials.
        believed: what the study says.
        near: the best fit so far without them.
        sites: all that may be missing.
    """
    odd = odd_one_out(near, fitter.trials)
    if odd is None:
        return []
    rows = fitter.rows_at(near)[odd.id]
    tasks = []
    for site in sites:
        if site.label in near.hypothesis.label:
            continue
        alone = Site(site.effect, site.where, (odd.id,))
        strength = site.key(site.effect.parameters[0].name)
        promised = []
        for moment in moments(site, [odd]):
            start = {**moment, strength: FAINT * moment[strength]}
            gain, amplitude = promise(fitter, believed, near, alone, start, odd, rows)
            promised.append((gain, {**start, strength: float(start[strength] * np.clip(amplitude, -1e3, 1e3))}))
        promised.sort(key=lambda p: -p[0])
        label = tuple(sorted((*near.hypothesis.label, site.label)))
        only = ((site.label, (odd.id,)),)
        tasks += [Task(label, start, near=near, max_iterations=30, only=only) for _, start in promised[:TRIED]]
    return tasks


def promise(
    fitter: Fitter,
    believed: Believed,
    near: Fit,
    site: Site,
    start: dict[str, float],
    trial: TrialData,
    rows: np.ndarray,
) -> tuple[float, float]:
    """By how much chi-squared of the trial would fall, and at which multiple of the start's strength."""
    made = hypothesis(believed, (*near.hypothesis.sites, site), start)
    initial = near.trials[trial.id].initial
    try:
        before, keep = fitter.residual(near.hypothesis, near.z, trial, initial)
        moved, _ = fitter.residual(made, made.start({**near.values(), **start}), trial, initial)
    except SimulationError:
        return 0.0, 0.0
    own, _ = np.linalg.qr(rows[keep][:, len(near.hypothesis.free) :])
    column = (moved - before)[keep]
    column = column - own @ (own.T @ column)
    norm = float(column @ column)
    if norm < 1e-12:
        return 0.0, 0.0
    amplitude = -float(column @ before[keep]) / norm
    return amplitude**2 * norm, amplitude
