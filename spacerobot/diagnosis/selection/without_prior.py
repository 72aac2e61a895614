"""Wrong beliefs beside missing physics: sets that bend believed values far, fitted without what is stated of these.

A constant that was fitted to look right with physics left out (the paper's c_eq) is wrong for whoever puts it back.
What was stated of it then holds the right set off, and some further effect would be named for making up for it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.judge import contradicted, moved
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
    near = {id(f): contradicted(f) for f in found.fits.values() if f in best or f in held}
    bent = [f for f in found.fits.values() if 0 < len(near.get(id(f), ())) <= FEW]
    tasks = [Task(f.hypothesis.label, {}, near=f, max_iterations=STEPS, patient=True, freed=near[id(f)]) for f in bent]
    freed = Found(found.baseline)
    run_tasks(pool, freed, tasks, report, "without what is stated of bent values")
    for fit in freed.fits.values():
        if score(fit) < score(found.fits[fit.hypothesis.label]) - EARN:
            found.fits[fit.hypothesis.label] = fit


def baseline_freed(pool: Pool, baseline: Fit) -> Fit | None:
    """The baseline with the values set free that are wrong; None where none is."""
    return let_go(baseline, contradicted(baseline), partial(_freed, pool))


def let_go(held: Fit, out: tuple[str, ...], freed: Callable[[Fit, tuple[str, ...]], Fit | None]) -> Fit | None:
    """A fit with the values set free that are wrong; None where none is.

    A value that is held off drags others with it (a damper stated too small: the spring and two masses), and the fit
    into a valley that is none of theirs. So all that the data move are set free, then taken back one at a time, the
    nearest to what is stated of it first, while that costs less than giving it up.

    Args:
        held: by what is stated.
        out: values that its data move or contradict.
        freed: fits its effects again, beginning at a fit, with these values free; None where that cannot be.
    """
    best = freed(held, out) if out else None
    while best is not None and len(best.hypothesis.freed) > 1:
        away = best.hypothesis.sigmas(best.z)
        nearest = min(best.hypothesis.freed, key=lambda k: abs(away[k]))
        fewer = freed(best, tuple(k for k in best.hypothesis.freed if k != nearest))
        if fewer is None or score(fewer) > score(best):
            break
        best = fewer
    return best


def _freed(pool: Pool, near: Fit, out: tuple[str, ...]) -> Fit | None:
    """No effect and these values free: from what is stated, and from where a fit stands; the lower."""
    tasks = (Task((), {}, freed=out), Task((), {}, near=near, freed=out))
    return min((fit for task in tasks if (fit := pool.here(task)) is not None), key=score, default=None)


def unheld(bench: Bench, one: Candidate) -> Candidate:
    """A candidate without what is stated of the values that its fit shows to be wrong, where that is worth it.

    Where more would have to be wrong than well may, something is missing that bends them all.

    Args:
        bench: under the weights of the fit.
        one: as fitted with what is stated.
    """
    fit = let_go(one.fit, moved(one.fit), bench.freed)
    if fit is None or len(moved(fit)) > FEW or score(fit) > score(one.fit):
        return one
    return bench.tested(fit)
