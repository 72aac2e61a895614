"""Further minima of the best set: contact makes the cost jagged along what is fitted by factors."""

from __future__ import annotations

from spacerobot.diagnosis.found import WORTH_A_FIT, Found, Report, run_tasks
from spacerobot.diagnosis.pool import Pool
from spacerobot.diagnosis.workshop import Task

FACTORS = ((0.75, 1.33), (0.88, 1.14))
"""Of each such value, from which the set is fitted again: widely first, then closely about the best of these."""


def other_minima(pool: Pool, found: Found, report: Report) -> None:
    """Fit the set that a verdict would prefer again, from either side of each value that is fitted by factors."""
    for factors in FACTORS if found.fits else ():
        best = found.preferred([*found.fits.values()])
        if found.baseline.cost - best.cost < WORTH_A_FIT:
            return
        label, values = best.hypothesis.label, best.values()
        only = tuple((s.label, s.trials) for s in best.hypothesis.sites if s.trials)
        tasks = [
            Task(label, {**values, f.key: by * values[f.key]}, best.initials(), max_iterations=20, only=only)
            for f in best.hypothesis.free
            if f.kind == "effect" and f.log
            for by in factors
        ]
        run_tasks(pool, found, tasks, report, "from either side of the best")
