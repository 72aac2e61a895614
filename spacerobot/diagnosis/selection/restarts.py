"""Further minima of the best set: contact makes the cost jagged along what is fitted by factors, and along moments."""

from __future__ import annotations

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.selection.search_state import WORTH_A_FIT, Found, Report, run_tasks

STEPS = ((0.3, 0.6), (0.15, 0.3))
"""Of each moment, in units of its scale, from which the set is fitted again: widely first, then closely."""


def other_minima(pool: Pool, found: Found, report: Report) -> None:
    """Move the set that a verdict would prefer on to lower valleys along each value that is fitted by factors.

    Fit it again from before and after each moment too: what a knock does depends on which bounce it falls between.
    Even where it leaves nothing but noise: between the wrong two bounces it may cost a hundred more of chi-squared's
    ten thousands.
    """
    best = found.preferred([*found.fits.values()] or [found.baseline])
    if found.baseline.cost - best.cost < WORTH_A_FIT:
        return
    logs = tuple(f.key for f in best.hypothesis.free if f.kind == "effect" and f.log)
    if logs:
        run_tasks(pool, found, [further(best, logs)], report, "other valleys of the best")
    for steps in STEPS:
        best = found.preferred([*found.fits.values()])
        values = best.values()
        moments = [(s.key(p.name), p.scale) for s in best.hypothesis.sites for p in s.effect.parameters if p.moment]
        signed = [by for step in steps for by in (-step, step)]
        made = best.hypothesis
        tasks = [
            Task(
                made.label,
                {**values, key: values[key] + by * scale},
                best.initials(),
                max_iterations=20,
                only=made.only,
            )
            for key, scale in moments
            for by in signed
        ]
        if tasks:
            run_tasks(pool, found, tasks, report, "before and after the best")


def further(fit: Fit, keys: tuple[str, ...]) -> Task:
    """A finished fit moved on to lower valleys along these values."""
    made = fit.hypothesis
    return Task(made.label, {}, near=fit, max_iterations=20, only=made.only, freed=made.freed, along=keys)
