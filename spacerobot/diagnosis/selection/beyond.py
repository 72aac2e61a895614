"""A robot that moves fitted by small motions that are bent as the whole robot is, about where the fit stands."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from functools import partial

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.machines.bent import NOTHING, Beyond
from spacerobot.diagnosis.machines.whole_rig import WholeRig, rig_model
from spacerobot.diagnosis.selection.bending import LEVEL, beyond
from spacerobot.diagnosis.selection.confirm import difference
from spacerobot.diagnosis.selection.precompile import as_believed
from spacerobot.diagnosis.selection.search_state import Found, Report, implausible_of, noise_of, run_tasks
from spacerobot.diagnosis.terms.hypothesis import Label, hypothesis
from spacerobot.support.errors import SpacerobotError

ROUNDS = 6
"""How often a fit and what the whole robot shows about it are found in turn."""

AGAIN = 16
"""Sets of effects, the best of a search, that are fitted again about what it found."""

NEAR = 0.1
"""Difference of the two in sensor sigmas, rms of the worst trial, that is left when they agree."""


def of_whole_robot(workshop: Workshop, near: Fit | None = None) -> Workshop:
    """The workshop whose machine bends as the whole robot does about a fit; of a plain rig the same.

    Args:
        workshop: of the study.
        near: the fit; that of the baseline where there is none.
    """
    if not isinstance(workshop.model, WholeRig):
        return workshop
    slopes: Beyond = NOTHING
    for _ in range(ROUNDS):
        try:
            found = beyond(workshop, as_believed(workshop) if near is None else near, slopes)
            workshop = Workshop(workshop.study, partial(rig_model, beyond=found))
            near = _fitted(workshop, near)
            if near is None or apart(workshop, near) < NEAR:
                break
            slopes = found
        except SpacerobotError:  # nothing is known of the whole robot: its check will say so
            break
    return workshop


def as_whole_robot(workshop: Workshop) -> Workshop:
    """The workshop whose machine bends as the whole robot does as believed; of a plain rig the same."""
    if not isinstance(workshop.model, WholeRig):
        return workshop
    try:
        level = {t.recorded: LEVEL for t in workshop.trials}
        return Workshop(workshop.study, partial(rig_model, beyond=beyond(workshop, as_believed(workshop), level)))
    except SpacerobotError:  # small motions are shown as they are
        return workshop


def again(
    pool: Pool, found: Found, report: Report, but_for: Callable[[Fit], Collection[tuple[str, str]]] = lambda fit: ()
) -> Found:
    """The baseline and the best sets of a search fitted again, by a machine that knows what it found.

    Args:
        pool: of that machine: it is bent about what was found, or has a part of it.
        found: by the search, of the machine as it was before.
        report: told of progress.
        but_for: effects and places of a fit that the machine itself has now.
    """
    near: dict[Label, Fit] = {}
    for fit in sorted(found.fits.values(), key=lambda f: f.cost)[:AGAIN]:
        known = but_for(fit)
        near.setdefault(tuple(one for one in fit.hypothesis.label if one not in known), fit)
    baseline = pool.here(Task((), {}, near=near.pop((), found.baseline)))
    new = replace(
        found,
        baseline=found.baseline if baseline is None else baseline,
        fits={},
        noise=noise_of(pool.workshop),
        implausible=implausible_of(pool.workshop),
    )
    tasks = [Task(label, {}, near=fit) for label, fit in near.items()]
    run_tasks(pool, new, tasks, report, "the best sets, once more")
    return new


def apart(workshop: Workshop, fit: Fit) -> float:
    """By how much the machine and the whole robot differ at a fit, in sensor sigmas: rms of the worst trial.

    Nothing where the whole robot cannot be simulated there; its check says so (`confirm.py`).
    """
    if not isinstance(workshop.model, WholeRig):
        return 0.0
    try:
        return max(difference(workshop, fit, trial) for trial in workshop.trials)
    except SpacerobotError:
        return 0.0


def _fitted(workshop: Workshop, near: Fit | None) -> Fit | None:
    """The same hypothesis fitted again, or the baseline."""
    if near is None or not near.hypothesis.sites:
        warm, initials = (None, None) if near is None else (near.values(), near.initials())
        return workshop.fitter().fit(hypothesis(workshop.model.believed, []), warm=warm, initials=initials)
    return workshop.run(Task(near.hypothesis.label, near.values(), near=near))
