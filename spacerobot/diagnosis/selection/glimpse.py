"""What a robot that moves seems to lack at first sight, about which it is bent before everything is searched.

What is missing moves a robot whose joints are free so far that a search about the baseline's motion finds nothing that
explains the trials, and tries everything at leisure. So one effect after another is taken in, each the best of those
that promise most, and the machine is bent about each set; the search then begins with the last one known.
"""

from __future__ import annotations

from collections.abc import Callable, Collection

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.screen import faint
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.machines.whole_rig import WholeRig
from spacerobot.diagnosis.selection.beyond import NEAR, apart, of_whole_robot
from spacerobot.diagnosis.selection.search_state import (
    Found,
    Report,
    noise_of,
    run_tasks,
    screened,
    share_of,
)
from spacerobot.diagnosis.terms.candidates import plainest
from spacerobot.diagnosis.terms.decision import MARGIN
from spacerobot.effects.effect import Effect

MOST = 3
"""Effects that are taken in, at most."""

PROMISING, STEPS = 4, 15
"""Effects that are fitted beside what is there, and steps of their fits."""


def glimpsed(
    workshop: Workshop, pooled: Callable[[Workshop], Pool], effects: Collection[Effect], report: Report
) -> tuple[Workshop, Fit | None]:
    """The workshop whose machine is bent about what seems to be missing, and that; of a plain rig the same, and None.

    Args:
        workshop: of a machine that is bent about its baseline.
        pooled: a pool of a workshop.
        effects: of the catalogue.
        report: told of progress.
    """
    near: Fit | None = None
    for _ in range(MOST if isinstance(workshop.model, WholeRig) else 0):
        with pooled(workshop) as pool:
            found = _one_more(pool, near, effects, report)
        if found is None:
            break
        before, near = near, found.best if found.best.hypothesis.sites else None
        if apart(workshop, found.best) > NEAR:
            workshop = of_whole_robot(workshop, found.best)
        grown = len(found.best.hypothesis.sites) > (0 if before is None else len(before.hypothesis.sites))
        if not grown or found.explained:
            break
    return workshop, near


def _one_more(pool: Pool, near: Fit | None, effects: Collection[Effect], report: Report) -> Found | None:
    """A set fitted about where the machine is bent now, and with what promises most beside it."""
    report("baseline", 0, 1)
    begun = pool.here(Task((), {}) if near is None else Task(near.hypothesis.label, {}, near=near))
    if begun is None:
        return None
    found = Found(begun, noise=noise_of(pool.workshop))
    if found.explained:
        return found
    rest = [s for s in pool.workshop.model.sites(effects) if s.label not in begun.hypothesis.label]
    report("screening", 0, len(rest))
    best = screened(pool, begun, rest).best()
    kinds = dict.fromkeys(plainest([label])[0] for label in best)  # of several laws of one friction the plainest
    tasks = [
        Task(
            tuple(sorted([*begun.hypothesis.label, s.site.label])),
            faint(s.site, s.start, share_of(s)),
            near=begun,
            max_iterations=STEPS,
            hopeless=begun.cost - MARGIN,
        )
        for s in [best[kind] for kind in kinds if kind in best][:PROMISING]
        if s.gain > MARGIN
    ]
    run_tasks(pool, found, tasks, report, "what promises most")
    return found
