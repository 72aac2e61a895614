"""What a search has fitted so far, and the running of its fits and screenings."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.screen import Screen, Screened, Screener, together
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.nameable import implausible, nameable
from spacerobot.diagnosis.selection.penalty import lead_over, score, simplest
from spacerobot.diagnosis.terms.candidates import contains, one_of_each
from spacerobot.diagnosis.terms.hypothesis import Label, Site

EXPLAINED = 1.02
"""chi-squared per sample below which a set may explain the data well enough not to start others afresh."""

WORTH_A_FIT = 15.0
"""Fall of the cost below which an effect is screened only: far from what it would have to earn."""

STEPS, ROUNDS = 30, 12
"""Of a fit that goes on where it ended, and how often it does: where a target bounces many times, the valley that leads
to the truth is narrow and bent.
"""

PARTS = 4
"""Parts of a screening, each done by one process; however many there are, the scores are the same."""

CLEAR = 300.0
"""A fit whose cost is this much above the best may be given up."""

Report = Callable[[str, int, int], None]
"""(what, done, of how many): told of progress."""


def silent(what: str, done: int, total: int) -> None:
    """Progress that nobody watches."""


@dataclass
class Found:
    """All that a search fitted and screened.

    Attributes:
        baseline: the refitted baseline.
        fits: the best fit of each set of effects.
        screens: what was screened, at the baseline and at the best single.
        screened: predicted fall of the cost by set of effects, fitted or not.
        singles: every site that was tried.
        noise: whether a fit leaves nothing but noise.
        implausible: why a fit, with its numbers, is not what its effects' names say; empty where it is.
    """

    baseline: Fit
    fits: dict[Label, Fit] = field(default_factory=dict)
    screens: list[Screen] = field(default_factory=list)
    screened: dict[Label, float] = field(default_factory=dict)
    singles: tuple[Site, ...] = ()
    noise: Callable[[Fit], bool] = lambda fit: True
    implausible: Callable[[Fit], str] = lambda fit: ""

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

    def explains(self, fit: Fit) -> bool:
        """Whether a fit leaves so little over that others need not begin afresh."""
        return fit.chi2 < EXPLAINED * fit.samples and self.noise(fit)

    @property
    def explained(self) -> bool:
        """Whether the best fit does."""
        return self.explains(self.best)

    @property
    def settled(self) -> bool:
        """Whether a fit does whose effects are what their names say."""
        return self.explains(self.preferred([self.baseline, *self.fits.values()]))

    def preferred(self, fits: Sequence[Fit]) -> Fit:
        """The one of these that a verdict would prefer; of those that it could not name, where there is no other."""
        fits = [f for f in fits if nameable(f) and not self.implausible(f)] or fits
        scores = {id(f): score(f) for f in fits}
        return simplest(sorted(fits, key=lambda f: scores[id(f)]), scores, score(self.baseline), self.noise)

    @property
    def in_play(self) -> Fit:
        """The fit of least cost; a preferred part of it instead, where that leaves nothing but noise and lacks less
        than a further effect must earn: however the larger set is varied then, it is not what is said.
        """
        chosen, best = self.preferred([self.baseline, *self.fits.values()]), self.best
        if not (self.explains(chosen) and contains(best.hypothesis.label, chosen.hypothesis.label)):
            return best
        return chosen if chosen.cost - best.cost < lead_over(self.baseline.cost - chosen.cost) else best

    def singles_by_cost(self) -> list[Fit]:
        """Fits of one effect, best first."""
        return sorted((f for f in self.fits.values() if len(f.hypothesis.sites) == 1), key=lambda f: f.cost)

    def one_of_each(self) -> list[Fit]:
        """The same, of several laws of one thing the plainest: five laws of one friction say one thing."""
        labels = [f.hypothesis.label for f in self.singles_by_cost()]
        return [self.fits[label] for label in one_of_each(labels, self.fits)]


def run_tasks(
    pool: Pool, found: Found, tasks: Sequence[Task], report: Report, what: str, *, stop: bool = False
) -> list[Task]:
    """Run tasks, each with a bar of the best cost so far; with `stop`, until one explains what none explained yet.

    Returns:
        those that were given up on what their first step promised.
    """

    def prepared(task: Task) -> Task:
        if task.patient:
            return task
        bar = found.best.cost + CLEAR if found.fits else np.inf
        if task.eager:
            bar = min(bar, found.baseline.cost - WORTH_A_FIT)
        return replace(task, hopeless=min(bar, task.hopeless))

    given_up, already = [], found.explained
    for done, (task, fit) in enumerate(pool.run(tasks, prepared), 1):
        found.keep(fit)
        if fit is not None and fit.given_up:
            given_up.append(task)
        report(what, done, len(tasks))
        if stop and not already and found.explained:
            break
    return given_up


def to_their_end(pool: Pool, found: Found, labels: Sequence[Label], report: Report, what: str) -> None:
    """Go on with the fits of sets that were not finished, while one of them still gains something."""
    for _ in range(ROUNDS):
        fits = [found.fits[label] for label in labels if label in found.fits]
        on = [f for f in fits if not f.converged]
        tasks = [Task(f.hypothesis.label, {}, near=f, max_iterations=STEPS, patient=True) for f in on]
        run_tasks(pool, found, tasks, report, what)
        if not any(found.fits[f.hypothesis.label].cost < f.cost - WORTH_A_FIT for f in on):
            break


def screened(pool: Pool, fit: Fit, sites: Sequence[Site], *, full: bool = False) -> Screen:
    """Scores of adding each site to a fit, a part of the sites in each process; `full`: at full sizes."""
    parts = [pool.aside(_screened_here, fit, sites[k::PARTS], full) for k in range(min(PARTS, max(len(sites), 1)))]
    return together([part() for part in parts], sites)


def _screened_here(workshop: Workshop, fit: Fit, sites: Sequence[Site], full: bool) -> Screen:
    screener = Screener(workshop.fitter(), workshop.model.believed)
    return screener.screen_full(fit, sites) if full else screener.screen(fit, sites)


def share_of(item: Screened) -> float:
    """Start of a near fit, as a share of the effect's own start."""
    share = 0.1 * item.amplitude
    if item.gain <= 0.0:
        return 0.05
    return float(np.copysign(np.clip(abs(share), 0.02, 1.0), share))


def effect_values(fit: Fit) -> Mapping[str, float]:
    """Values of a fit's effect parameters, by key."""
    return {k: v for k, v in fit.values().items() if "@" in k}


def noise_of(workshop: Workshop) -> Callable[[Fit], bool]:
    """Whether a fit leaves nothing but noise, each asked once."""
    return functools.cache(lambda fit: workshop.left_by(fit).adequate)


def implausible_of(workshop: Workshop) -> Callable[[Fit], str]:
    """Why a fit is not what its effects' names say, by what is typical of the recordings."""
    return lambda fit: implausible(fit.hypothesis.sites, fit.values(), workshop.model.size_at)
