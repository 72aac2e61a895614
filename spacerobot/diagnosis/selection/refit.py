"""The sets in play fitted to a part of the trials, from starts that owe nothing to the rest.

The baseline first, from what is believed; then each set, the smaller before the larger, beside the best fit of a part
of it, at the start that promises most there. Where none explains the trials, from the effects' own starts too.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.screen import Screener, faint
from spacerobot.diagnosis.fitting.starts import effect_starts, informed_starts
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.nested_laws import inherited
from spacerobot.diagnosis.selection.search_state import (
    Found,
    implausible_of,
    noise_of,
    run_tasks,
    share_of,
    silent,
    to_their_end,
)
from spacerobot.diagnosis.terms.candidates import by_name, contains, refines, simpler
from spacerobot.diagnosis.terms.decision import PENALTY
from spacerobot.diagnosis.terms.hypothesis import Label, Site, label_of
from spacerobot.effects.registry import effect

FIRST, RIVAL_STEPS = 8, 12
"""Steps of the chosen set's fit from a near start, for what it led to is a better one to go on from; of its rivals'."""

COLD = 2
"""The effects' own starts that a set is fitted from where no near one explains the trials."""


def refit(
    pool: Pool,
    chosen: Sequence[Site],
    rivals: Sequence[Sequence[Site]],
    thorough: bool,
    known: Collection[tuple[str, str]] | None = None,
) -> Found:
    """Fit the chosen set, its rivals, and all their parts.

    Args:
        pool: of the trials to fit.
        chosen: the set that all trials led to.
        rivals: sets that come near it.
        thorough: whether to begin afresh where no near start explains the trials.
        known: (effect, where) of the catalogue that was searched, which may have been told to do without some; special
            cases beyond it are not fitted. None for all.
    """
    baseline = pool.here(Task((), {}))
    assert baseline is not None  # the believed rig itself can be simulated, or RigModel had refused it
    sets = _with_parts(pool.workshop.model, chosen, rivals, known)
    singles = {s.label: Site(s.effect, s.where) for one in sets.values() for s in one}
    found = Found(
        baseline,
        singles=tuple(singles.values()),
        noise=noise_of(pool.workshop),
        implausible=implausible_of(pool.workshop),
    )
    mine = label_of(chosen)
    for label, sites in sets.items():
        run_tasks(pool, found, [_near(pool, found, label, sites, label == mine)], silent, "")
        if label == mine:
            to_their_end(pool, found, [label], silent, "")
    for whole in (chosen, *rivals) if thorough else ():
        label = label_of(whole)
        own = found.fits.get(label)
        if (label and not found.explained) or (label == mine and (own is None or not found.explains(own))):
            run_tasks(pool, found, _afresh(pool, label, whole), silent, "")
    return found


def _with_parts(
    model: Machine,
    chosen: Sequence[Site],
    rivals: Sequence[Sequence[Site]],
    known: Collection[tuple[str, str]] | None,
) -> dict[Label, tuple[Site, ...]]:
    """Every set and all its parts, special cases of the chosen one's effects too; the smaller first."""
    sets: dict[Label, tuple[Site, ...]] = {}
    for sites in (chosen, *rivals):
        for size in range(1, len(sites) + 1):
            for part in itertools.combinations(sites, size):
                sets.setdefault(label_of(part), part)
    for label in simpler(tuple(s.label for s in chosen)):
        if known is not None and not set(known).issuperset(by_name(label)):
            continue
        sets.setdefault(label, tuple(model.site(effect(name), where) for name, where in label))
    return dict(sorted(sets.items(), key=lambda item: (len(item[0]), _size(item[1]))))


def _size(sites: Sequence[Site]) -> int:
    return sum(len(s.effect.parameters) for s in sites)


def _near(pool: Pool, found: Found, label: Label, sites: Sequence[Site], mine: bool) -> Task:
    """A set beside the best fit of a part of it: what is new at the start that promises most there.

    A rival whose first step promises less than its parameters cost is given up: no judge would prefer it.
    """
    parts = [f for f in found.fits.values() if contains(label, f.hypothesis.label)]
    near = min([found.baseline, *parts], key=lambda f: f.cost)
    new = [s for s in sites if s.label not in near.hypothesis.label]
    start: dict[str, float] = {}
    for site in new:
        start |= _inherited(site, near) or _promising(pool, near, site)
    only = tuple((s.label, s.trials) for s in sites if s.trials)
    if mine:
        return Task(label, start, near=near, max_iterations=FIRST, loose=True, patient=True, only=only)
    bar = near.cost - PENALTY * (_size(sites) - _size(near.hypothesis.sites))
    return Task(label, start, near=near, max_iterations=RIVAL_STEPS, loose=True, eager=True, hopeless=bar, only=only)


def _inherited(site: Site, near: Fit) -> dict[str, float]:
    """A general effect where its special case stands in a fit."""
    for special in near.hypothesis.sites:
        if special.where == site.where and refines(site.effect.name, special.effect.name):
            return inherited(site, special, near)
    return {}


def _promising(pool: Pool, near: Fit, site: Site) -> Mapping[str, float]:
    workshop = pool.workshop
    best = Screener(workshop.fitter(), workshop.model.believed).screen(near, [site]).best().get(site.label)
    return effect_starts([site])[0] if best is None else faint(site, best.start, share_of(best))


def _afresh(pool: Pool, label: Label, sites: Sequence[Site]) -> list[Task]:
    """From the free approaches, at the effects' own starts and at what the recordings suggest."""
    only = tuple((s.label, s.trials) for s in sites if s.trials)
    informed = informed_starts(sites[0], pool.workshop.trials) if len(sites) == 1 else []
    return [Task(label, start, patient=True, only=only) for start in [*informed, *effect_starts(sites)][:COLD]]
