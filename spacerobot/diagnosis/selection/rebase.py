"""The baseline fitted again from where sets of effects stand: contacts make many minima, for it as for any set.

What a set gains over a baseline in a worse minimum than its own is no sign of its effects: friction of nothing at all
would be named.
"""

from __future__ import annotations

from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.selection.search_state import Found, Report

BEST = 4
"""Sets of least cost that are tried."""


def rebased(pool: Pool, found: Found, report: Report) -> float:
    """Put the baseline where it fits best of these; by how much its cost fell.

    Args:
        pool: runs the fits.
        found: holds baseline and sets.
        report: told of progress.
    """
    before = found.baseline.cost
    best = sorted(found.fits.values(), key=lambda f: f.cost)[:BEST]
    tasks = [Task((), {}, near=fit, hopeless=before) for fit in best]
    for done, (_, again) in enumerate(pool.run(tasks), 1):
        report("baseline, from where the best sets stand", done, len(tasks))
        if again is not None and again.cost < found.baseline.cost:
            found.baseline = again
    return before - found.baseline.cost
