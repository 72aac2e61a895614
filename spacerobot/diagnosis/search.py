"""The search: baseline, all singles, all pairs scored and the best fitted. It finds fits; it judges nothing."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from spacerobot.diagnosis.candidates import contains, simpler
from spacerobot.diagnosis.data import TrialData
from spacerobot.diagnosis.fit import HOPE
from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.hypothesis import Label, Site
from spacerobot.diagnosis.one_trial import knocks
from spacerobot.diagnosis.pool import Pool
from spacerobot.diagnosis.screen import Screen, Screened, Screener, faint, together
from spacerobot.diagnosis.starts import effect_starts, informed_starts
from spacerobot.diagnosis.weigh import score, simplest, worth
from spacerobot.diagnosis.workshop import Task, Workshop
from spacerobot.effects.registry import effect

TOP_SCREENED = 4
TOP_FITTED = 4
TOP_PAIRS = 4
NEAR_ITERATIONS, OTHER_ITERATIONS = 8, 3
"""Steps of a fit from the best-scored start of an effect, and from its others; the best of all go on from there."""

EXPLAINED = 1.02
"""chi-squared per sample below which a single effect explains the data well enough not to start others afresh."""

WORTH_A_FIT = 15.0
"""Fall of the cost below which an effect is screened only: far from what it would have to earn."""

PARTS = 4
"""Parts of a screening, each done by one process; however many there are, the scores are the same."""

CLEAR = 300.0
"""A fit whose cost is this much above the best may be given up."""

Report = Callable[[str, int, int], None]
"""(what, done, of how many): told of progress."""


@dataclass
class Found:
    """All that a search fitted and screened.

    Attributes:
        baseline: the refitted baseline.
        fits: the best fit of each set of effects.
        screens: what was screened, at the baseline and at the best single.
        screened: predicted fall of the cost by set of effects, fitted or not.
        singles: every site that was tried.
    """

    baseline: Fit
    fits: dict[Label, Fit] = field(default_factory=dict)
    screens: list[Screen] = field(default_factory=list)
    screened: dict[Label, float] = field(default_factory=dict)
    singles: tuple[Site, ...] = ()

    def keep(self, fit: Fit | None) -> None:
        """Remember a fit if it is the best of its kind."""
        if fit is None:
            return
        old = self.fits.get(fit.hypothesis.label)
        if old is None or fit.cost < old.cost:
            self.fits[fit.hypothesis.label] = fit

    @property
    def best(self) -> Fit:
        """The fit of least cost, the baseline included."""
        return min([self.baseline, *self.fits.values()], key=lambda f: f.cost)

    def preferred(self, fits: Sequence[Fit]) -> Fit:
        """The one of these that a verdict would prefer."""
        scores = {id(f): score(f) for f in [self.baseline, *fits]}
        return simplest(sorted(fits, key=lambda f: scores[id(f)]), scores, self.baseline)

    def singles_by_cost(self) -> list[Fit]:
        """Fits of one effect, best first."""
        return sorted((f for f in self.fits.values() if len(f.hypothesis.sites) == 1), key=lambda f: f.cost)


def _share(item: Screened) -> float:
    """Start of a near fit, as a share of the effect's own start."""
    share = 0.1 * item.amplitude
    if item.gain <= 0.0:
        return 0.05
    return float(np.copysign(np.clip(abs(share), 0.02, 1.0), share))


def search(pool: Pool, sites: Sequence[Site], report: Report, *, baseline: Fit | None = None) -> Found:
    """Fit the baseline, every single effect, and the most promising pairs.

    Args:
        pool: runs the fits.
        sites: effects and places to try.
        report: told of progress.
        baseline: the refitted baseline, where it is known already.
    """
    workshop = pool.workshop
    report("baseline", 0, 1)
    if baseline is None:
        baseline = pool.here(Task((), {}))
        assert baseline is not None  # the believed rig itself can be simulated, or RigModel had refused it
    found = Found(baseline, singles=tuple(sites))
    report("screening", 0, len(sites))
    first = _screen(pool, baseline, sites)
    found.screens.append(first)
    found.screened.update({(k,): v.gain for k, v in first.best().items()})

    best = first.best()
    tasks: list[Task] = []
    hopeless: list[Task] = []
    for s in first.scored:
        most = NEAR_ITERATIONS if s is best[s.site.label] else OTHER_ITERATIONS
        start = faint(s.site, s.start, _share(s))
        task = Task((s.site.label,), start, near=baseline, max_iterations=most, loose=True, eager=True)
        # a further start of which so little is promised would be given up at its first step
        (tasks if s is best[s.site.label] or HOPE * s.gain > WORTH_A_FIT else hopeless).append(task)
    given_up = _run(pool, found, tasks, report, "single effects") + hopeless
    if not _explained(found.best):
        _run(pool, found, _unfinished(found), report, "single effects, the best to their end")
    if not _explained(found.best):  # then what its first step promised may have been too little to go by
        _run(pool, found, [replace(t, eager=False) for t in given_up], report, "single effects, at leisure")
    if not _explained(found.best):
        alone = knocks(workshop.fitter(), workshop.model.believed, found.baseline, found.singles)
        _run(pool, found, alone, report, "knocks in one trial alone")
    promising = [f.hypothesis.label for f in found.singles_by_cost()[:TOP_FITTED]]
    # what adds little near the baseline may still fit from a start of its own
    promising += [(k,) for k in list(first.best())[:TOP_SCREENED] if (k,) not in promising]
    _run(
        pool,
        found,
        _starts(found, promising, workshop.trials),
        report,
        "single effects, from several starts",
        stop=True,
    )
    if found.singles_by_cost():
        _pairs(pool, found, first, report)
        _simplify(pool, found, report)
    return found


def _screen(pool: Pool, fit: Fit, sites: Sequence[Site]) -> Screen:
    """Scores of adding each site to a fit, a part of the sites in each process."""
    parts = [pool.aside(_screened, fit, sites[k::PARTS]) for k in range(min(PARTS, max(len(sites), 1)))]
    return together([part() for part in parts], sites)


def _screened(workshop: Workshop, fit: Fit, sites: Sequence[Site]) -> Screen:
    return Screener(workshop.fitter(), workshop.model.believed).screen(fit, sites)


def _starts(found: Found, labels: Sequence[Label], trials: Sequence[TrialData]) -> list[Task]:
    """From where the near fits stopped, then each from its own first start, then from its second.

    What explains the data already needs no other start.
    """
    by_label = {s.label: s for s in found.singles}
    near = [t for t in _unfinished(found) if t.label in labels]
    some = {f.hypothesis.label for f in found.fits.values() if any(s.trials for s in f.hypothesis.sites)}
    good = {label for label, f in found.fits.items() if _explained(f)}
    labels = [label for label in labels if label not in some | good]  # the first have begun everywhere already
    cold: list[list[Task]] = [[], []]
    for label in labels:
        sites = [by_label[one] for one in label]
        starts = [s for site in sites for s in informed_starts(site, trials)] if len(sites) == 1 else []
        for k, start in enumerate([*starts, *effect_starts(sites)][: 1 if good else 2]):
            # from the free approaches: a baseline that misses much has bent the trials' starts as well
            cold[k].append(Task(label, start))
    return [*near, *cold[0], *cold[1]]


def _unfinished(found: Found) -> list[Task]:
    """The best near fits, from where they stopped."""
    best = found.singles_by_cost()[:TOP_FITTED]
    return [Task(f.hypothesis.label, {}, near=f, max_iterations=30) for f in best if not f.converged]


def _pairs(pool: Pool, found: Found, first: Screen, report: Report) -> None:
    single = found.preferred(found.singles_by_cost())
    explained = found.baseline.cost - single.cost
    rest = [s for s in found.singles if s.label not in single.hypothesis.label]
    report("screening pairs", 0, len(rest))
    second = _screen(pool, single, rest)
    found.screens.append(second)
    for gain, a, b in first.pairs():
        found.screened.setdefault(tuple(sorted((a.site.label, b.site.label))), gain)
    tasks = []
    for label, item in list(second.best().items())[:TOP_PAIRS]:
        both = tuple(sorted((*single.hypothesis.label, label)))
        found.screened[both] = max(found.screened.get(both, 0.0), explained + item.gain)
        if item.gain > max(WORTH_A_FIT, worth(explained) / HOPE):
            start = faint(item.site, item.start, _share(item))
            bar = single.cost - worth(explained)
            tasks.append(Task(both, start, near=single, max_iterations=20, hopeless=bar, eager=True))
    for gain, a, b in first.pairs()[: 0 if _explained(single) else TOP_PAIRS]:
        both = tuple(sorted((a.site.label, b.site.label)))
        nested = contains([a.site.label], [b.site.label]) or contains([b.site.label], [a.site.label])
        if nested or gain < WORTH_A_FIT or any(t.label == both for t in tasks):
            continue
        tasks.append(Task(both, {**a.start, **b.start}, max_iterations=30))
    _run(pool, found, tasks, report, "pairs of effects", stop=True)


def _simplify(pool: Pool, found: Found, report: Report) -> None:
    """What the best set could do without: its special cases and subsets, from where it ended.

    Those that were fitted already too: contact makes many minima, and what is left out may have led to a better one.
    """
    best = found.preferred([*found.fits.values()])
    tasks = []
    for label in simpler(best.hypothesis.label):
        sites = [Site(effect(name), where) for name, where in label]
        starts = effect_starts(sites, effect_values(best))[: 1 if label in found.fits else 2]
        tasks += [Task(label, start, near=best, max_iterations=20) for start in starts]
    _run(pool, found, tasks, report, "simpler sets of effects")


def _explained(fit: Fit) -> bool:
    return fit.chi2 < EXPLAINED * fit.samples


def _run(
    pool: Pool, found: Found, tasks: Sequence[Task], report: Report, what: str, *, stop: bool = False
) -> list[Task]:
    """Run tasks, each with a bar of the best cost so far; with `stop`, until one explains what none explained yet.

    Returns:
        those that were given up on what their first step promised.
    """

    def prepared(task: Task) -> Task:
        bar = found.best.cost + CLEAR if found.fits else np.inf
        if task.eager:
            bar = min(bar, found.baseline.cost - WORTH_A_FIT)
        return replace(task, hopeless=min(bar, task.hopeless))

    given_up, already = [], _explained(found.best)
    for done, (task, fit) in enumerate(pool.run(tasks, prepared), 1):
        found.keep(fit)
        if fit is not None and fit.given_up:
            given_up.append(task)
        report(what, done, len(tasks))
        if stop and not already and _explained(found.best):
            break
    return given_up


def effect_values(fit: Fit) -> Mapping[str, float]:
    """Values of a fit's effect parameters, by key."""
    return {k: v for k, v in fit.values().items() if "@" in k}
