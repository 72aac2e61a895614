"""What is said after a search: the simplest model as good as the best that stands, and what cannot be told from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit, interval
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.instead import instead
from spacerobot.diagnosis.selection.model_choice import as_good, choice, pays, ratio
from spacerobot.diagnosis.selection.nameable import not_shown
from spacerobot.diagnosis.selection.nested_laws import by_chance, not_excluded
from spacerobot.diagnosis.selection.penalty import priced
from spacerobot.diagnosis.selection.variants import Variants
from spacerobot.diagnosis.selection.without_prior import unheld
from spacerobot.diagnosis.terms.candidates import by_name, contains
from spacerobot.diagnosis.terms.decision import STRIKING, TIE, WORTH_OF_REST
from spacerobot.diagnosis.terms.hypothesis import Label, Site, label_of


def unshown(fit: Fit) -> str:
    """Why an effect of a fit is not to be named, as its intervals tell; empty where all are shown."""
    values = fit.values()
    for site in fit.hypothesis.sites:
        intervals = {k: interval(fit, k, 1.0)[1] for k in (site.key(p.name) for p in site.effect.parameters)}
        why = not_shown(site, values, intervals)
        if why:
            return why
    return ""


def retained(growth: Growth, whole: Candidate) -> Growth:
    """Where nothing was worth naming between knocks, what whole trials had shown, if it predicts the pieces better too.

    A fall that was cut in two tells less of drag than a whole one, and nothing against it.

    Args:
        growth: of the pieces.
        whole: the choice before they were cut.
    """
    found = next((c for c in growth.considered if c.label == whole.label), None)
    if growth.after.sites or found is None or ratio(found, growth.considered_baseline) > 1.0 - WORTH_OF_REST:
        return growth
    bench = growth.bench
    weights = bench.weights
    before, after = weighed(bench, bench.again(found.fit), growth.considered_baseline.fit)
    if unshown(after.fit):
        bench.weights = weights
        return growth
    return replace(growth, before=before, after=after)


def weighed(bench: Bench, chosen: Fit, baseline: Fit) -> tuple[Candidate, Candidate]:
    """Baseline and choice, fitted and tried again under the weights that what the choice leaves over asks for."""
    bench.weigh(chosen)

    def again(fit: Fit) -> Candidate:
        return bench.tested(bench.again(fit))

    before = again(baseline)
    return before, before if chosen is baseline else again(chosen)


class Conclusion:
    """Of the sets that a search met.

    Attributes:
        bench: that tried them.
        sites: effects and places on offer.
        screened: what each set promised before it was fitted, as a share of what the baseline leaves over.
    """

    def __init__(self, bench: Bench, sites: dict[tuple[str, str], Site], screened: Mapping[Label, float]) -> None:
        """Of a search's bench and what it shares."""
        self.bench, self.sites, self.screened = bench, sites, screened

    def of(self, tested: list[Candidate], baseline: Candidate, barred: Mapping[Label, str] | None = None) -> Growth:
        """The simplest as good as the best that stands: of each that does not, the reason is kept."""
        refused, variants = dict(barred or {}), Variants(self.bench, self.sites)
        stated, weights = bool(self.bench.model.expected({})), self.bench.weights
        while True:
            open_to = [c for c in tested if c.label not in refused]
            chosen = choice(open_to, baseline, self.bench.trials)
            before, after = weighed(self.bench, chosen.fit, baseline.fit)
            if stated:
                before, after = self.unheld(before, after)
            why = self.refusal(before, after, stated)
            if not why:
                break
            refused[chosen.label] = why
            self.bench.weights = weights
            tested += variants.varied(chosen, tested, variants.parts(chosen))
        near = [c for c in open_to if c is not chosen and c is not baseline and c.simplicity <= chosen.simplicity]
        near = [c for c in near if ratio(c, chosen) < 1.0 + TIE]
        rivals = tuple(c for c in (*near, *self.ahead_of(chosen, open_to)) if not unshown(self.bench.again(c.fit)))
        less = self.without_chance(after, [c.label for c in tested])
        if less is not after:
            rivals = tuple(r for r in rivals if r.label != less.label and not contains(r.label, less.label))
            after = less
        if one := instead(self.bench, after, tuple(self.sites.values()), refused):
            after, *others = one
            rivals = (*rivals, *others)
            tested.append(self.as_considered(after, weights))
        if stated:
            more = not_excluded(self.bench, after.fit, self.sites)
            rivals = (*rivals, *(self.bench.tested(fit) for fit in more))
        said = by_name(after.label)  # another form of what is said is no other explanation
        rivals = tuple(r for r in rivals if by_name(r.label) != said)
        ranked = tuple(sorted(tested, key=lambda c: c.error))
        sites = tuple(self.sites.values())
        return Growth(self.bench, before, after, rivals, ranked, tuple(self.screened.items()), refused, sites, weights)

    def as_considered(self, one: Candidate, weights: Mapping[str, float]) -> Candidate:
        """A candidate that was met after the search, under the weights of those beside it."""
        own, self.bench.weights = self.bench.weights, weights
        found = self.bench.tested(self.bench.again(one.fit))
        self.bench.weights = own
        return found

    def ahead_of(self, chosen: Candidate, tested: Sequence[Candidate]) -> list[Candidate]:
        """The simplest of other sets that predict unseen trials clearly better on the whole, if not throughout."""
        others = [c for c in tested if not set(chosen.label) <= set(c.label)]
        ahead = [c for c in others if ratio(c, chosen) < 1.0 - STRIKING]
        best = min(ahead, key=lambda c: c.error, default=chosen)
        return sorted((c for c in ahead if as_good(c, best, chosen)), key=lambda c: (c.size, c.error))[:1]

    def unheld(self, before: Candidate, after: Candidate) -> tuple[Candidate, Candidate]:
        """Baseline and choice without what is stated of values that either shows to be wrong."""
        free = unheld(self.bench, before)
        return free, free if after is before else unheld(self.bench, after)

    def refusal(self, before: Candidate, after: Candidate, stated: bool) -> str:
        """Why a choice does not stand under the weights that it asks for; empty where it does."""
        if after is before:
            return ""
        if by_chance(priced(before.fit) - priced(after.fit), after.size, len(self.sites)):
            return f"gains no more than chance would under the noise that {'is stated' if stated else 'it leaves'}"
        if not stated and not pays(after, before, self.bench.trials):
            return "predicts unseen data no better once readings weigh what it leaves over"
        return unshown(after.fit)

    def without_chance(self, chosen: Candidate, tried: Sequence[Label]) -> Candidate:
        """Without effects that gain no more than chance would beside the others, of sets that were tried."""
        for site in chosen.sites:
            rest = [s for s in chosen.sites if s is not site]
            if not rest or label_of(rest) not in tried:
                continue
            fit = self.bench.fitted_as(chosen.fit, rest, {})
            gain = np.inf if fit is None else priced(fit) - priced(chosen.fit)
            if fit is not None and by_chance(gain, len(site.effect.parameters), len(self.sites)):
                return self.without_chance(self.bench.tested(fit), tried)
        return chosen
