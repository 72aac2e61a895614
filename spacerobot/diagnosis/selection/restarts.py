"""Further minima of the best set: contact makes the cost jagged along what is fitted by factors, and along moments."""

from __future__ import annotations

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.selection.search_state import WORTH_A_FIT, Found, Report, run_tasks

FACTORS = ((0.75, 1.33), (0.88, 1.14))
"""Of each such value, from which the set is fitted again: widely first, then closely about the best of these."""

STEPS = ((0.3, 0.6), (0.15, 0.3))
"""Of each moment, in units of its scale, from which the set is fitted again: widely first, then closely."""


def other_minima(pool: Pool, found: Found, report: Report) -> None:
    """Fit the set that a verdict would prefer again, from either side of each value that is fitted by factors.

    From before and after each moment too: what a knock does depends on which bounce it falls between. Even where it
    leaves nothing but noise: between the wrong two bounces it may cost a hundred more of chi-squared's ten thousands.
    """
    for factors in FACTORS if found.fits else ():
        best = found.preferred([*found.fits.values()])
        if found.baseline.cost - best.cost < WORTH_A_FIT:
            return
        values = best.values()
        logs = [f.key for f in best.hypothesis.free if f.kind == "effect" and f.log]
        tasks = [_again(best, key, by * values[key]) for key in logs for by in factors]
        run_tasks(pool, found, tasks, report, "from either side of the best")
    for steps in STEPS if found.fits else ():
        best = found.preferred([*found.fits.values()])
        values = best.values()
        moments = [(s.key(p.name), p.scale) for s in best.hypothesis.sites for p in s.effect.parameters if p.moment]
        signed = [by for step in steps for by in (-step, step)]
        tasks = [_again(best, key, values[key] + by * scale) for key, scale in moments for by in signed]
        if tasks:
            run_tasks(pool, found, tasks, report, "before and after the best")


def _again(best: Fit, key: str, value: float) -> Task:
    """The set again, from where it ended but for one value."""
    made = best.hypothesis
    return Task(made.label, {**best.values(), key: value}, best.initials(), max_iterations=20, only=made.only)
