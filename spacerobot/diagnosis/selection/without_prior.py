"""Wrong beliefs beside missing physics: sets that bend believed values far, fitted without what is stated of these.

A constant that was fitted to look right with physics left out (the paper's c_eq) is wrong for whoever puts it back.
What was stated of it then holds the right set off, and some further effect would be named for making up for it.
"""

from __future__ import annotations

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.selection.judge import moved
from spacerobot.diagnosis.selection.penalty import score
from spacerobot.diagnosis.selection.search_state import Found, Report, run_tasks
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.decision import EARN, FEW

BEST = 4
"""Sets of least cost that are looked at, with all that they hold."""

STEPS = 20


def set_free(pool: Pool, found: Found, report: Report) -> None:
    """Fit the best sets, and what they hold, again without what is stated of the values that each of them bends.

    One takes its set's place where it is worth more than it gives up, a value being given up as an effect is taken in.

    Args:
        pool: runs the fits.
        found: holds the sets.
        report: told of progress.
    """
    best = sorted(found.fits.values(), key=lambda f: f.cost)[:BEST]
    held = [f for f in found.fits.values() if any(contains(b.hypothesis.label, f.hypothesis.label) for b in best)]
    bent = [f for f in found.fits.values() if (f in best or f in held) and 0 < len(moved(f)) <= FEW]
    tasks = [Task(f.hypothesis.label, {}, near=f, max_iterations=STEPS, patient=True, freed=moved(f)) for f in bent]
    freed = Found(found.baseline)
    run_tasks(pool, freed, tasks, report, "without what is stated of bent values")
    for fit in freed.fits.values():
        if score(fit) < score(found.fits[fit.hypothesis.label]) - EARN:
            found.fits[fit.hypothesis.label] = fit


def baseline_freed(pool: Pool, baseline: Fit) -> Fit | None:
    """The baseline with the values it moves set free; None where it moves none."""
    out = moved(baseline)
    return pool.here(Task((), {}, near=baseline, freed=out)) if out else None
