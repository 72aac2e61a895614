"""Pairs of effects: a single beside what promises most, what the best could do without, and a stream's mirror."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.screen import Screen, faint
from spacerobot.diagnosis.fitting.starts import EVERY, SIZES, effect_starts, moments, sized
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.selection.nameable import held_labels
from spacerobot.diagnosis.selection.nested_laws import inherited
from spacerobot.diagnosis.selection.search_state import (
    WORTH_A_FIT,
    Found,
    Report,
    effect_values,
    run_tasks,
    screened,
    share_of,
)
from spacerobot.diagnosis.terms.candidates import by_name, contains, exchanged, mirrored, plainest, redundant, simpler
from spacerobot.diagnosis.terms.decision import MARGIN
from spacerobot.diagnosis.terms.hypothesis import Label, Site
from spacerobot.effects.registry import effect
from spacerobot.effects.trend import SUFFIX, TREND, may_change

TOP_PAIRS = 4
TOP_SINGLES = 5
"""Single effects that are paired with one another by what they were fitted to, whatever their screening promised."""

TOP_BESIDE = 3
"""Single effects beside which others are sought, where what is found beside the preferred one is not enough."""

TOP_FULL = 6
"""Effects that are fitted beside a fit for what they promise at full size."""

ROUNDS = 2
"""Times that pairs are sought; again where what they could do without shows a better single effect."""

MOST = 4
"""Effects of a set, at most."""

BEAM, TOP_LARGER = 4, 2
"""Sets of one size that are grown, and further effects that are fitted beside each."""

ALIKE = 0.9
"""Cosine between what two effects do to the baseline's residuals from which they count as twins."""


def pairs(pool: Pool, found: Found, first: Screen, report: Report) -> None:
    """Fit the most promising pairs, and what the best of them could do without.

    Args:
        pool: runs the fits.
        found: holds the single effects, and takes the pairs.
        first: the screening at the baseline.
        report: told of progress.
    """
    paired: set[Label] = set()
    for _ in range(ROUNDS if found.singles_by_cost() else 0):
        singles = found.singles_by_cost()
        # where one that changes over the trials does not explain them, it may be making up for what is missing beside
        single = found.preferred([f for f in singles if found.explained or not f.hypothesis.changes] or singles)
        if single.hypothesis.label in paired:
            break  # the pairs have led to no better single
        _fit_pairs(pool, found, single, None if paired else first, report)
        paired.add(single.hypothesis.label)
        run_tasks(pool, found, _mirrored(found), report, "late for early")
        run_tasks(pool, found, _twins(found, first), report, "what acts alike")
        run_tasks(pool, found, _other_moments(pool, found), report, "at other moments")
        simplify(pool, found, report)
        if found.explained:
            break


def more(pool: Pool, found: Found, report: Report) -> None:
    """Sets of three effects and more: the best few of a size with what promises most beside each.

    Not the best alone: where three are missing, the best pair may hold one that makes up for two. It goes on while
    more than noise is left and a larger set earns its place.

    Args:
        pool: runs the fits.
        found: holds pairs, and takes the larger sets.
        report: told of progress.
    """
    grown = False
    for size in range(2, MOST):
        sets: dict[Label, Fit] = {}
        for fit in sorted(found.fits.values(), key=lambda f: f.cost):
            if len(fit.hypothesis.label) == size:
                sets.setdefault(plainest(fit.hypothesis.label), fit)  # five laws of one friction are one set
        if found.explained or not sets:
            break
        least = found.best.cost
        for fit in [*sets.values()][:BEAM]:
            rest = [s for s in found.singles if not redundant([*fit.hypothesis.label, s.label])]
            tasks = [replace(t, patient=True) for t in _beside(found, fit, screened(pool, fit, rest))[:TOP_LARGER]]
            run_tasks(pool, found, tasks, report, "further effects", stop=True)
            if found.explained:
                break
        if found.best.cost > least - MARGIN:
            break
        grown = True
        if not found.best.converged:
            on = Task(found.best.hypothesis.label, {}, near=found.best, max_iterations=30)
            run_tasks(pool, found, [on], report, "the best set to its end")
        run_tasks(pool, found, _mirrored(found), report, "late for early")
    for _ in range(MOST if grown else 0):  # what is left of a set may be too much still
        before = found.preferred([*found.fits.values()])
        simplify(pool, found, report)
        run_tasks(pool, found, _mirrored(found), report, "late for early")
        if found.preferred([*found.fits.values()]) is before:
            break


def changing(pool: Pool, found: Found, most: int = TOP_SINGLES) -> list[Task]:
    """The best single effects, and those of the best set, each as one that grows or fades over the trials.

    Of several laws of one thing the plainest first: five richer ones are no reason to do without it.

    Args:
        pool: of the rig.
        found: what was fitted so far.
        most: single effects of unlike things.
    """
    tasks = []
    best: dict[Label, list[Fit]] = {}
    for fit in found.singles_by_cost():
        if found.baseline.cost - fit.cost > WORTH_A_FIT:
            best.setdefault(plainest(fit.hypothesis.label), []).append(fit)
    few = [f for kind, laws in [*best.items()][:most] for f in (found.fits.get(kind, laws[0]), laws[0])]
    for fit in {id(f): f for f in (*few, found.best)}.values():
        for site in fit.hypothesis.sites:
            if site.trials or not may_change(site.effect):
                continue
            new = pool.workshop.model.site(effect(site.effect.name + SUFFIX), site.where)
            label = exchanged(fit.hypothesis.label, site.label, new.label)
            start = {**effect_values(fit), **inherited(new, site, fit), new.key(TREND): 0.0}
            tasks.append(Task(label, start, near=fit, max_iterations=30, patient=True))
    return tasks


def _fit_pairs(pool: Pool, found: Found, single: Fit, first: Screen | None, report: Report) -> None:
    """Pairs of a single effect with what promises most beside it, and those that promise most at the baseline."""
    rest = [s for s in found.singles if s.label not in single.hypothesis.label]
    report("screening pairs", 0, len(rest))
    second = screened(pool, single, rest)
    found.screens.append(second)
    pairs = [] if first is None else first.pairs()
    for gain, a, b in pairs:
        found.screened.setdefault(tuple(sorted((a.site.label, b.site.label))), gain)
    near, afresh = _beside(found, single, second), []
    for gain, a, b in pairs[: 0 if found.explains(single) else TOP_PAIRS]:
        both = tuple(sorted((a.site.label, b.site.label)))
        nested = contains([a.site.label], [b.site.label]) or contains([b.site.label], [a.site.label])
        if nested or gain < WORTH_A_FIT or any(t.label == both for t in near):
            continue
        afresh.append(Task(both, {**a.start, **b.start}, max_iterations=30))
    run_tasks(pool, found, near, report, "pairs of effects")  # all of them: two may explain the data
    if first is not None and not found.explained:
        run_tasks(pool, found, _of_singles(found), report, "pairs of the best single effects", stop=True)
        for other in [f for f in found.one_of_each()[:TOP_BESIDE] if f is not single]:
            if found.explained:
                break
            others = [s for s in found.singles if s.label not in other.hypothesis.label]
            run_tasks(pool, found, _beside(found, other, screened(pool, other, others)), report, "pairs of effects")
    if not found.explained:
        full = at_full_size(pool, found, single, rest, report)
        run_tasks(pool, found, full, report, "pairs of effects, full size", stop=True)
    if not found.explained:
        run_tasks(pool, found, afresh, report, "pairs of effects, afresh", stop=True)
    best = found.in_play
    best_of = best.hypothesis.label
    if len(best_of) > 1:
        # a single that misses much has bent the trials' starts
        again = [] if found.explains(best) else [Task(best_of, effect_values(best))]
        again += [] if best.converged else [Task(best_of, {}, near=best, max_iterations=30)]
        run_tasks(pool, found, again, report, "the best pair to its end")


def _beside(found: Found, single: Fit, second: Screen) -> list[Task]:
    """A single effect with those that promise most beside it."""
    gained = found.baseline.cost - single.cost
    tasks = []
    for label, item in list(second.best().items())[:TOP_PAIRS]:
        both = tuple(sorted((*single.hypothesis.label, label)))
        found.screened[both] = max(found.screened.get(both, 0.0), gained + item.gain)
        if item.gain > WORTH_A_FIT:
            start = faint(item.site, item.start, share_of(item))
            bar = single.cost - MARGIN
            tasks.append(Task(both, start, near=single, max_iterations=20, hopeless=bar, eager=True))
    return tasks


def at_full_size(pool: Pool, found: Found, near: Fit, sites: Sequence[Site], report: Report) -> list[Task]:
    """Further effects beside a fit that promise more at full size than any fit has found, those that promise most."""
    report("screening at full size", 0, len(sites))
    tasks = []
    for item in screened(pool, near, sites, full=True).scored:
        label = tuple(sorted((*near.hypothesis.label, item.site.label)))
        known = found.fits.get(label)
        least = near.cost if known is None else min(near.cost, known.cost)
        if near.cost - item.gain < least - WORTH_A_FIT:
            tasks.append(Task(label, item.start, near=near, max_iterations=20))
    return tasks[:TOP_FULL]


def _of_singles(found: Found) -> list[Task]:
    """Pairs of the best single effects, from the values that each was fitted to alone.

    Friction that brings a body to rest hardly moves the recordings where it is faint, so no screening promises it.
    """
    top = [f for f in found.one_of_each() if found.baseline.cost - f.cost > WORTH_A_FIT][:TOP_SINGLES]
    tasks = []
    for one, other in itertools.combinations(top, 2):  # the better one first: the fit begins at it
        a, b = one.hypothesis.label, other.hypothesis.label
        both = tuple(sorted((*a, *b)))
        alone = any(s.trials for f in (one, other) for s in f.hypothesis.sites)
        if not (alone or contains(a, b) or contains(b, a)):
            tasks.append(Task(both, effect_values(other), near=one, max_iterations=20))
    return tasks


def _mirrored(found: Found) -> list[Task]:
    """Where a stream is early in the best fit, or in the smallest that explains the data, the other stream late, from
    where it ended: what comes before it was caused has no name.
    """
    explaining = [f for f in found.fits.values() if found.explains(f)]
    smallest = min(explaining, key=lambda f: (len(f.hypothesis.sites), f.cost), default=found.best)
    tasks = []
    for fit in {id(f): f for f in (found.best, smallest)}.values():
        label = fit.hypothesis.label
        other = mirrored(label, effect_values(fit), [s.label for s in found.singles])
        if other is None or (other[0] in found.fits and found.fits[other[0]].cost < fit.cost + MARGIN):
            continue
        (late,) = set(other[0]) - set(label)
        only = tuple((one if one in other[0] else late, trials) for one, trials in fit.hypothesis.only)
        tasks.append(Task(other[0], {**fit.values(), **other[1]}, fit.initials(), only=only))
    return tasks


def _twins(found: Found, first: Screen) -> list[Task]:
    """The best set with an effect exchanged for one that moved the baseline alike.

    Which of the two has led the pairs may be a matter of the last digits: a late stream and a smoothed one.
    """
    best, known = found.in_play, first.best()
    bound = held_labels(best)
    here = [s.label for s in best.hypothesis.sites]
    tasks = []
    for own in here if len(here) > 1 else ():
        for other, item in known.items():
            if other in here or own not in known or not _alike(known[own].column, item.column):
                continue
            label = tuple(sorted([*(one for one in here if one != own), other]))
            alone = found.fits.get((other,))
            start = item.start if alone is None else effect_values(alone)
            if label not in found.fits and not bound.intersection(label):
                tasks.append(Task(label, {**start, **effect_values(best)}, near=best, max_iterations=20))
    return tasks


def _other_moments(pool: Pool, found: Found) -> list[Task]:
    """The best set with what happens at a moment at others, all over the trials and either way, from their approaches.

    Which moment it came to hangs on what the rest had not explained then; and a knock before a touch moves all that
    follows, so that no fit finds it from one behind.
    """
    best, tasks = found.best, []
    for own in best.hypothesis.sites if len(best.hypothesis.sites) > 1 and not found.explained else ():
        for start in moments(own, pool.workshop.trials)[::EVERY]:
            for share in (SIZES[0], -SIZES[0]) if own.effect.two_sided else (SIZES[0],):
                values = {**effect_values(best), **sized(own, start, share)}
                tasks.append(Task(best.hypothesis.label, values, max_iterations=20, only=best.hypothesis.only))
    return tasks


def _alike(a: np.ndarray, b: np.ndarray) -> bool:
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return size > 0.0 and abs(float(a @ b)) > ALIKE * size


def simplify(pool: Pool, found: Found, report: Report) -> None:
    """What the best sets could do without: their special cases and subsets, from where they ended.

    Both the one that a verdict would prefer and the one in play, whose further effect may have taken the place of the
    first; what a bound holds is left out of what is tried. Those that were fitted already too: contact makes
    many minima, and what is left out may have led to a better one.
    """
    done: set[Label] = set()
    while True:
        both = {f.hypothesis.label: f for f in (found.preferred([*found.fits.values()]), found.in_play)}
        fresh = [f for label, f in both.items() if label not in done]
        if not fresh:
            return
        done.update(both)  # a special case that is preferred now has special cases of its own
        tasks = [task for f in fresh for task in _without(pool, found, f)]
        run_tasks(pool, found, tasks, report, "simpler sets of effects")


def _without(pool: Pool, found: Found, best: Fit) -> list[Task]:
    """The special cases and subsets of one set, from where it ended."""
    tasks: list[Task] = []
    known, bound = {s.label for s in found.singles}, held_labels(best)
    for label in simpler(best.hypothesis.label):
        if not known.issuperset(by_name(label)):  # a special case that the catalogue was to do without
            continue
        if bound.intersection(label):  # it would be held there too
            continue
        sites = [pool.workshop.model.site(effect(name), where) for name, where in label]
        starts = effect_starts(sites, effect_values(best))[: 1 if label in found.fits else 2]
        starts += [{**starts[0], **own} for own in _inherited(sites, best)]
        tasks += [Task(label, start, near=best, max_iterations=20) for start in starts]
    return tasks


def _inherited(sites: Sequence[Site], general: Fit) -> list[dict[str, float]]:
    """Starts of a special case: each value of the same unit that the general effect at its place came to."""
    values, known = general.values(), general.hypothesis.label
    out = []
    for site in sites:
        if site.label in known:
            continue
        for other in general.hypothesis.sites:
            if other.where != site.where or other.label in [s.label for s in sites]:
                continue
            for p in other.effect.parameters:
                same = [q for q in site.effect.parameters if q.unit == p.unit]
                out.append({site.key(q.name): values[other.key(p.name)] for q in same})
    return [start for start in out if start]
