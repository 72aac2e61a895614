"""Effects in their other forms: a sensor's filter of higher order, where the plain one does not leave noise alone."""

from __future__ import annotations

from collections.abc import Collection

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.screen import faint
from spacerobot.diagnosis.fitting.starts import effect_starts
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.selection.pairs import simplify
from spacerobot.diagnosis.selection.search_state import WORTH_A_FIT, Found, Report, run_tasks, screened, share_of
from spacerobot.diagnosis.terms.hypothesis import Site, label_of
from spacerobot.effects.registry import effect


def formed(pool: Pool, found: Found, report: Report) -> None:
    """Fit every form of an effect that comes in several, beside what is best without an effect at its place.

    Where noise alone is left by the plain form, that will do; where it takes two effects at that place, a late reading
    that is smoothed as well, one of another form may do it alone, and where it takes another one, a late reading, a
    filter that is late by as much may be what is there.

    Args:
        pool: runs the fits.
        found: holds the plain forms, and takes the others.
        report: told of progress.
    """
    before = found.best
    for site in found.singles:
        if not site.effect.forms:
            continue
        model, settled = pool.workshop.model, found.settled
        there = [s.effect.name for s in found.best.hypothesis.sites if _at(s, site.where, model.sensors)]
        late = site.where in model.sensors and len(there) == 1 and there != [site.effect.name]
        if settled and not (late or len(there) > 1):
            continue
        lightly = settled and late  # what is there does it alone: another form must do it as well
        others = model.in_forms(effect(site.effect.name), site.where)
        for beside in (_rest if lightly else _without)(found, site.where, model.sensors):
            report("screening forms", 0, len(others))
            tasks = []
            for label, item in screened(pool, beside, others).best().items():
                if item.gain > WORTH_A_FIT:
                    both = tuple(sorted((*beside.hypothesis.label, label)))
                    start = faint(item.site, item.start, share_of(item))
                    task = Task(both, start, near=beside, max_iterations=30, eager=lightly, patient=not lightly)
                    tasks.append(task)
            run_tasks(pool, found, tasks, report, "other forms of effects")
            if found.settled:
                break
        if not found.settled and [f.hypothesis.label for f in found.singles_by_cost()[:1]] == [(site.label,)]:
            # what a filter hides has bent the values of all that was fitted without it
            afresh = [Task((o.label,), start, max_iterations=30) for o in others for start in effect_starts([o])]
            run_tasks(pool, found, afresh, report, "other forms of effects, afresh", stop=True)
    if found.best is not before:
        simplify(pool, found, report)


def _at(site: Site, where: str, sensors: Collection[str]) -> bool:
    """Whether an effect is at a place: of a sensor also what makes another one early, which is this one late."""
    return site.where == where or (site.effect.relative and where in sensors)


def _rest(found: Found, where: str, sensors: Collection[str]) -> list[Fit]:
    """The best set without what it has at a place, and the baseline where that was never fitted."""
    rest = label_of(s for s in found.best.hypothesis.sites if not _at(s, where, sensors))
    return [found.fits.get(rest, found.baseline)]


def _without(found: Found, where: str, sensors: Collection[str]) -> list[Fit]:
    """The baseline, and the best single effect and the best set of those that have none at a place."""
    others = [f for f in found.fits.values() if not any(_at(s, where, sensors) for s in f.hypothesis.sites)]
    singles = [f for f in others if len(f.hypothesis.label) == 1]
    best = [min(some, key=lambda f: f.cost) for some in (singles, others) if some]
    return list({id(f): f for f in (found.baseline, *best)}.values())
