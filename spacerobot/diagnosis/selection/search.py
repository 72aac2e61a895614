"""The search: baseline, all singles, all pairs scored and the best fitted. It finds fits; it judges nothing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from spacerobot.diagnosis.fitting.descent import HOPE
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.screen import faint
from spacerobot.diagnosis.fitting.starts import effect_starts, informed_starts
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.selection.forms import formed
from spacerobot.diagnosis.selection.heirs import heirs
from spacerobot.diagnosis.selection.one_trial import knocks
from spacerobot.diagnosis.selection.pairs import at_full_size, changing, more, pairs, simplify
from spacerobot.diagnosis.selection.rebase import rebased
from spacerobot.diagnosis.selection.restarts import further, other_minima
from spacerobot.diagnosis.selection.search_state import (
    CLEAR,
    WORTH_A_FIT,
    Found,
    Report,
    implausible_of,
    noise_of,
    run_tasks,
    screened,
    share_of,
    to_their_end,
)
from spacerobot.diagnosis.selection.since import since
from spacerobot.diagnosis.terms.candidates import one_of_each
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import MARGIN
from spacerobot.diagnosis.terms.hypothesis import Label, Site
from spacerobot.support.errors import InputError

TOP_SCREENED = 4
TOP_FITTED = 4
TOP_RESIZED = 5
CHANGING_FIRST = 2
"""Single effects that are let change over the trials before pairs are sought; all others after."""

ON_THEIR_WAY = 2
"""Best single effects that go on while a fit's steps still bring something, where nothing explains the data yet."""

STARTS = 4
"""Starts of one effect that are fitted, of all that are screened."""

NEAR_ITERATIONS, OTHER_ITERATIONS = 8, 3
"""Steps of a fit from the best-scored start of an effect, and from its others; the best of all go on from there."""


TRAPPED = 0.5
"""Share of its misfit that a baseline loses by beginning elsewhere, from which on it had been trapped."""


def search(
    pool: Pool, sites: Sequence[Site], report: Report, near: Fit | None = None, baseline: Fit | None = None
) -> Found:
    """Fit the baseline, every single effect, and the most promising pairs.

    Args:
        pool: runs the fits.
        sites: effects and places to try.
        report: told of progress.
        near: a set that is known to explain much already.
        baseline: the fit without effects, where it is known already.
    """
    workshop = pool.workshop
    report("baseline", 0, 1)
    first_try = baseline is None
    baseline = pool.here(Task((), {})) if baseline is None else baseline
    if baseline is None:  # each trial can be simulated as believed, or the door had refused it; a fit moved on
        raise InputError("the rig as believed cannot be fitted to these trials", where=str(workshop.study.path))
    found = Found(baseline, singles=tuple(sites), noise=noise_of(workshop), implausible=implausible_of(workshop))
    if near is not None:
        run_tasks(pool, found, [Task(near.hypothesis.label, {}, near=near)], report, "what was seen at first sight")
    report("screening", 0, len(sites))
    first = screened(pool, baseline, sites)
    found.screens.append(first)
    found.screened.update({(k,): v.gain for k, v in first.best().items()})

    best = first.best()
    tasks: list[Task] = []
    hopeless: list[Task] = []
    begun = Counter[tuple[str, str]]()
    for s in first.scored:
        begun[s.site.label] += 1
        if begun[s.site.label] > STARTS:
            continue
        most = NEAR_ITERATIONS if s is best[s.site.label] else OTHER_ITERATIONS
        start = faint(s.site, s.start, share_of(s))
        task = Task((s.site.label,), start, near=baseline, max_iterations=most, loose=True, eager=True)
        # a further start of which so little is promised would be given up at its first step
        (tasks if s is best[s.site.label] or HOPE * s.gain > WORTH_A_FIT else hopeless).append(task)
    given_up = run_tasks(pool, found, tasks, report, "single effects") + hopeless
    if first_try:
        fall = rebased(pool, found, report)
        if fall > max(CLEAR, TRAPPED * (found.baseline.cost + fall - found.baseline.samples)):
            return search(pool, sites, report, near, found.baseline)  # all that began at it was trapped as well
    if not found.explained:
        run_tasks(pool, found, _unfinished(found), report, "single effects, the best to their end")
    if not found.explained:  # then what its first step promised may have been too little to go by
        run_tasks(pool, found, [replace(t, eager=False) for t in given_up], report, "single effects, at leisure")
    _in_some_trials(pool, found, report)
    if not found.explained:
        run_tasks(pool, found, at_full_size(pool, found, baseline, sites, report), report, "single effects, full size")
        run_tasks(pool, found, _resized(found), report, "single effects, from other sizes")
    known = {(s.label,) for s in found.singles}
    promising = [f.hypothesis.label for f in found.one_of_each()[:TOP_FITTED]]
    # what adds little near the baseline may still fit from a start of its own
    screened_best = one_of_each([(k,) for k in first.best()], known)
    promising += [label for label in screened_best[:TOP_SCREENED] if label not in promising]
    # so may what hardly shows before it is met, where the recordings say how far things went
    promising += [
        (s.label,)
        for s in (() if found.explained else found.singles)
        if (s.label,) not in promising and informed_starts(s, workshop.trials)
    ]
    # and one that takes a law's place: near the baseline, which has that law, it was no fit at all
    promising += [
        f.hypothesis.label
        for f in found.singles_by_cost()
        if f.cost > found.baseline.cost and f.hypothesis.removed and f.hypothesis.label not in promising
    ]
    run_tasks(
        pool,
        found,
        _starts(found, promising, workshop.trials),
        report,
        "single effects, from several starts",
        stop=True,
    )
    if not found.explained:
        run_tasks(
            pool,
            found,
            heirs(found, found.one_of_each()[:TOP_FITTED], workshop.model.in_forms),
            report,
            "richer laws",
            stop=True,
        )
    if not found.explained:
        unfinished = [t.label for t in _unfinished(found)[:ON_THEIR_WAY]]
        to_their_end(pool, found, unfinished, report, "single effects, on their way")
    fading, explained = changing(pool, found, CHANGING_FIRST), found.explained
    if explained:  # but for so little as may be the change of what is named: its first step tells
        fading = [replace(t, patient=False, eager=True, hopeless=_near(t).cost - MARGIN) for t in fading]
    # before what is sought beside them: two make up for the fading of one
    run_tasks(pool, found, fading, report, "the best, changing over the trials", stop=True)
    for task in fading if explained else []:  # what does not change is no other explanation
        if task.label in found.fits and found.fits[task.label].cost > _near(task).cost - MARGIN:
            del found.fits[task.label]
    pairs(pool, found, first, report)
    formed(pool, found, report)
    more(pool, found, report)
    if not found.explained:
        tried = {(t.label, id(t.near)) for t in fading}
        others = [t for t in changing(pool, found) if (t.label, id(t.near)) not in tried]
        run_tasks(pool, found, others, report, "effects that change over the trials")
        _from_some_trial_on(pool, found, found.preferred([*found.fits.values()] or [found.baseline]), report)
    chosen = found.preferred([*found.fits.values()])
    other_minima(pool, found, report)
    if found.preferred([*found.fits.values()]) is not chosen:
        simplify(pool, found, report)
    return found


def _in_some_trials(pool: Pool, found: Found, report: Report) -> None:
    """What acts in one trial, or from some trial on, beside the baseline and the best single effect.

    A knock whatever explains the data: of one trial in many a law for all may take up all but what noise would leave.
    """
    workshop = pool.workshop
    for near in (found.baseline, *found.one_of_each()[:1]):
        alone = knocks(workshop.fitter(), workshop.model.believed, near, found.singles)
        run_tasks(pool, found, alone, report, "knocks in one trial alone")
        if not found.explained:
            _from_some_trial_on(pool, found, near, report)


def _from_some_trial_on(pool: Pool, found: Found, near: Fit, report: Report) -> None:
    later = since(pool.workshop.fitter(), pool.workshop.model.believed, near, found.singles)
    run_tasks(pool, found, later, report, "sensors that change from some trial on")


def _starts(found: Found, labels: Sequence[Label], trials: Sequence[TrialData]) -> list[Task]:
    """From where the near fits stopped, then each from its own first start, then from its second.

    What explains the data already needs no other start.
    """
    by_label = {s.label: s for s in found.singles}
    near = [t for t in _unfinished(found) if t.label in labels]
    some = {f.hypothesis.label for f in found.fits.values() if any(s.trials for s in f.hypothesis.sites)}
    good = {label for label, f in found.fits.items() if found.explains(f)}
    labels = [label for label in labels if label not in some | good]  # the first have begun everywhere already
    cold: list[list[Task]] = [[], []]
    for label in labels:
        sites = [by_label[one] for one in label]
        starts = [s for site in sites for s in informed_starts(site, trials)] if len(sites) == 1 else []
        for k, start in enumerate([*starts, *effect_starts(sites)][: 1 if good else 2]):
            # from the free approaches: a baseline that misses much has bent the trials' starts as well; where a law is
            # replaced, far from where it will fit, so that it falls by fits and starts
            cold[k].append(Task(label, start, patient=any(site.effect.removes for site in sites)))
    # those that nobody gives up take longest: begun last, they would keep one process while all others wait
    return [*near, *(t for tasks in cold for t in sorted(tasks, key=lambda t: not t.patient))]


def _near(task: Task) -> Fit:
    assert task.near is not None
    return task.near


def _resized(found: Found) -> list[Task]:
    """The best single effects on their way to lower valleys along their strengths.

    Friction that stops a body in one more trial, or in one less, is a minimum of its own.
    """
    return [
        further(fit, (site.key(site.effect.strength.name),))
        for fit in found.one_of_each()[:TOP_RESIZED]
        for site in fit.hypothesis.sites
        if fit.cost < found.baseline.cost - WORTH_A_FIT and not (site.trials or site.effect.removes)
    ]


def _unfinished(found: Found) -> list[Task]:
    """The best near fits, from where they stopped."""
    best = found.one_of_each()[:TOP_FITTED]
    return [Task(f.hypothesis.label, {}, near=f, max_iterations=30) for f in best if not f.converged]
