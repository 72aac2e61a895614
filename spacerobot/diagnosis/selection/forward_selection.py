"""From a baseline to the simplest model that predicts unseen trials as well as any: effects added while they pay.

For recordings whose noise is not known and whose best model is not exact, where information criteria keep
rewarding arbitrary terms: what is left out of a fit decides, not what is in it. The search is a beam over the
number of parameters that effects bring along; the choice among all that it met is made at the end. It was made under
weights that no noise bears out, so that descents end where they should; the choice must gain more than chance would
bring, under the noise that is stated or that it leaves.

Every body, joint and axis grows alone: what is said of it hangs on no other, and on no reading that does not feel the
effects in question (`model_choice.py`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.fit_store import Kept
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.bench import Bench, Promise
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.conclusion import Conclusion
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.model_choice import as_good, choice, distinct, ratio
from spacerobot.diagnosis.selection.nested_laws import inherited
from spacerobot.diagnosis.selection.variants import Variants
from spacerobot.diagnosis.terms.candidates import plainer, redundant
from spacerobot.diagnosis.terms.decision import TIE, WORTH_OF_REST
from spacerobot.diagnosis.terms.hypothesis import Label, Site, label_of
from spacerobot.effects.effect import Effect
from spacerobot.effects.registry import effect

PATIENCE = 2
"""The search ends when so many more parameters have brought nothing that is worth naming."""

BEAM = 3
"""How many models of one size are built upon."""

TRIED = 5
"""How many models of one size, those that promise most, are fitted and tried on unseen trials."""

PAIRS = 2
"""How many pairs of one size are fitted because of what they promise together."""

ANYWAY = 2
"""How many are fitted even where they promise nothing beyond what was reached: promises are linear, gaps are not."""

MOST = 6
"""Parameters that effects may bring along."""


@dataclass(frozen=True, eq=False)
class Ahead:
    """A candidate before it is fitted: what it grows from, and what one effect more promises, or two at once."""

    near: Candidate
    promise: Promise
    beside: Promise | None = None

    @property
    def left(self) -> float:
        """What it would leave over."""
        return self.promise.left

    def fitted(self, bench: Bench) -> Fit | None:
        """Fitted; None where it cannot be, or where the fit is no physics."""
        if self.beside is None:
            return bench.fitted(self.near.fit, self.promise)
        sites = (*self.near.sites, self.promise.site, self.beside.site)
        return bench.fitted_as(self.near.fit, sites, {**self.promise.start, **self.beside.start})


def grow(
    model: Machine,
    *,
    effects: Iterable[Effect] | None = None,
    most: int = MOST,
    threads: int = 1,
    reached: Callable[[int], None] | None = None,
    kept: Kept | None = None,
) -> Growth:
    """The simplest model that predicts unseen trials about as well as the best that a beam search meets.

    Args:
        model: whose baseline to begin with.
        effects: the catalogue; all known effects if None.
        most: parameters that effects may bring along.
        threads: of the fits.
        reached: told how many parameters the candidates have that are now tried.
        kept: what an earlier run had found.

    Raises:
        SimulationError: the baseline cannot be fitted.
    """
    catalogue = None if effects is None else list(effects)
    bench = Bench(model, threads, kept)
    search = _Search(bench, bench.model.sites(catalogue))
    return search.run(most, reached or (lambda size: None))


def among(bench: Bench, chosen: Sequence[Site], rivals: Sequence[Sequence[Site]]) -> tuple[Growth, Fit | None]:
    """What a bench's trials alone lead to among some sets, and one of these sets fitted to them, under its weights.

    Args:
        bench: of the trials.
        chosen: the set that is fitted whatever is led to.
        rivals: further sets; all are grown effect by effect from the baseline, the most promising one first, and what
            is met on the way takes part.

    Raises:
        SimulationError: the baseline cannot be fitted, or not be tried.
    """
    search = _Search(bench, list({s.label: s for one in (chosen, *rivals) for s in one}.values()))
    baseline = search.begun()
    tested = [baseline]
    for sites in (chosen, *rivals):
        search.grown(sites, tested)
    weights = bench.weights
    growth = search.concluded(tested, baseline)
    label = label_of(chosen)
    if growth.after.label == label:
        return growth, growth.after.fit
    met = next((c for c in tested if c.label == label), None)
    if met is None:
        return growth, None
    bench.weights = weights
    bench.weigh(met.fit)
    return growth, bench.again(met.fit)


def no_larger(growth: Growth, most: int, why: str) -> Growth:
    """Concluded once more, among the sets of so many parameters at most.

    Args:
        growth: of all sets.
        most: parameters that effects may bring along.
        why: what speaks against the larger ones.
    """
    larger = {c.label: why for c in growth.considered if c.size > most}
    return _again(growth).concluded(list(growth.considered), growth.considered_baseline, larger)


def holding(growth: Growth, known: Sequence[Site], why: str) -> Growth:
    """Concluded once more, among the sets that hold what is known; with the choice so far, or all of it but one effect.

    Args:
        growth: of all sets.
        known: effects that are there.
        why: what speaks against the other sets.
    """
    search, tested = _again(growth), list(growth.considered)
    labels = {s.label for s in known}
    others = [s for s in growth.after.sites if s.label not in labels]
    for less in (None, *others):
        sites = [*(s for s in others if s is not less), *known]
        if not redundant([s.label for s in sites]) and label_of(sites) not in {c.label for c in tested}:
            search.grown(sites, tested)
    without = {c.label: why for c in tested if not labels <= set(c.label)}
    return search.concluded(tested, growth.considered_baseline, without)


def _again(growth: Growth) -> _Search:
    """A search that goes on from what was found, under the weights at which its sets are considered."""
    growth.bench.weights = growth.weights
    search = _Search(growth.bench, growth.sites)
    search.screened = dict(growth.screened)
    return search


class _Search:
    def __init__(self, bench: Bench, sites: Sequence[Site]) -> None:
        self.bench = bench
        self.sites = {s.label: s for s in sites}
        self.screened: dict[Label, float] = {}
        self.whole = self.reached = np.inf  # what the baseline leaves over, and the best so far

    def run(self, most: int, reached: Callable[[int], None]) -> Growth:
        baseline = self.begun()
        tested = [baseline]
        self.whole = self.reached = self.bench.left(baseline.fit)
        ahead: dict[int, dict[Label, Ahead]] = {}
        bests: list[Candidate] = []
        for size in range(most + 1):
            reached(size)
            bests.append(min(tested, key=lambda c: c.error))
            tired = size > PATIENCE and as_good(bests[-1 - PATIENCE], bests[-1], baseline)
            if tired and not self.waiting(size, ahead):
                break
            layer = [baseline] if size == 0 else self.layer(list(ahead.pop(size, {}).values()))
            if size and layer:
                first = min(range(len(layer)), key=lambda k: layer[k].cost)
                layer[first] = self.restarted(layer[first], baseline)
            tested += layer if size else []
            layer.sort(key=lambda c: c.error)
            better = 1.0 - (TIE if size < 2 else WORTH_OF_REST)  # a pair may need two weak singles, no more
            ahead_of = [c for c in layer if not size or ratio(c, bests[-1]) < better]
            for one in distinct(ahead_of)[:BEAM]:
                self.look_ahead(one, most, ahead)
            if size == 0:
                self.look_at_pairs(baseline, most, ahead)
        variants = Variants(self.bench, self.sites)
        chosen = choice(tested, baseline, self.bench.trials)
        tested += variants.varied(chosen, tested, variants.reworded(chosen))
        chosen = choice(tested, baseline, self.bench.trials)
        tested += variants.varied(chosen, tested, variants.exchanged(chosen, tested))
        chosen = choice(tested, baseline, self.bench.trials)
        tested += variants.varied(chosen, tested, variants.formed(chosen))
        return self.concluded(tested, baseline)

    def waiting(self, size: int, ahead: Mapping[int, Mapping[Label, Ahead]]) -> bool:
        """Whether sets of so many parameters or more promise much: a law of three had no turn before."""
        bar = (1.0 - 2.0 * WORTH_OF_REST) ** 2 * self.reached
        return any(one.left < bar for at, layer in ahead.items() if at >= size for one in layer.values())

    def begun(self) -> Candidate:
        """The baseline, under the weights of a search."""
        fit = self.bench.baseline()
        self.bench.sharpen(fit)
        return self.bench.tested(self.bench.again(fit))

    def grown(self, sites: Sequence[Site], tested: list[Candidate]) -> None:
        """A set, one effect after the other from the largest part of it that was met; all that is met is tried."""
        label = {s.label for s in sites}
        here = max((c for c in tested if set(c.label) <= label), key=lambda c: (len(c.sites), -c.error))
        while left := [s for s in sites if s.label not in here.label]:
            promises = sorted(self.bench.promises(here.fit, left), key=lambda p: p.left)
            fit = next((f for p in promises if (f := self.fitted(here.fit, p)) is not None), None)
            if fit is None:
                return
            here = self.bench.tested(fit)
            tested.append(here)

    def fitted(self, near: Fit, promise: Promise) -> Fit | None:
        """A promise fitted; of a richer law the best of this and what begins where one that it refines ends."""
        new, bench = promise.site, self.bench
        fits = [bench.fitted(near, promise)]
        for name in plainer(new.effect.name):
            special = bench.model.site(effect(name), new.where)
            if (plain := bench.fitted_as(near, (*near.hypothesis.sites, special), {})) is not None:
                sites = (*near.hypothesis.sites, new)
                fits.append(bench.fitted_as(plain, sites, inherited(new, special, plain)))
        return min((f for f in fits if f is not None), key=lambda f: f.cost, default=None)

    def concluded(
        self, tested: list[Candidate], baseline: Candidate, barred: Mapping[Label, str] | None = None
    ) -> Growth:
        """What is said of all that was met; `barred` sets, and why, take no part."""
        return Conclusion(self.bench, self.sites, self.screened).of(tested, baseline, barred)

    def layer(self, ahead: list[Ahead]) -> list[Candidate]:
        """The most promising candidates of one size, fitted and tried on unseen trials."""
        out: list[Candidate] = []
        bar = (1.0 - TIE) * self.reached
        for place, promise in enumerate(sorted(ahead, key=lambda p: p.left)[: 2 * TRIED]):
            if len(out) == TRIED or (place >= ANYWAY and promise.left > bar):
                break
            fit = promise.fitted(self.bench)
            if fit is not None:
                one = self.bench.tested(fit)
                self.reached = min(self.reached, self.bench.left(fit))
                out.append(one)
        return out

    def restarted(self, one: Candidate, baseline: Candidate) -> Candidate:
        """A candidate fitted again with the shapes of its effects at their own starts, if that is better.

        Each effect was found beside fewer: how it acts may have settled to make up for one that came later.
        """
        values, best = one.fit.values(), one.fit
        if len(one.sites) > 1:
            for site in one.sites:
                for p in (p for p in site.effect.parameters if p.shape and not p.moment and len(p.starts) > 1):
                    for value in p.starts:
                        start = {**{k: v for k, v in values.items() if "@" in k}, site.key(p.name): value}
                        fit = self.bench.fitted_as(baseline.fit, one.sites, start)
                        if fit is not None and fit.cost < (1.0 - TIE) * best.cost:
                            best = fit
        return one if best is one.fit else self.bench.tested(best)

    def look_ahead(self, one: Candidate, most: int, ahead: dict[int, dict[Label, Ahead]]) -> None:
        """What each further effect promises."""
        further = [
            s
            for s in self.sites.values()
            if s.label not in one.label
            and one.size + len(s.effect.parameters) <= most
            and not redundant([t.label for t in (*one.sites, s)])
        ]
        found = {p.site.label: p for p in self.bench.promises(one.fit, further)}
        for site in further:
            if site.label not in found:
                continue
            promise = Ahead(one, found[site.label])
            name = tuple(sorted((*one.label, site.label)))
            layer = ahead.setdefault(one.size + len(site.effect.parameters), {})
            if name not in layer or promise.left < layer[name].left:
                layer[name] = promise
                self.screened[name] = promise.left / self.whole

    def look_at_pairs(self, one: Candidate, most: int, ahead: dict[int, dict[Label, Ahead]]) -> None:
        """What two further effects promise together, where neither may alone."""
        found: dict[int, int] = {}
        for first, second in self.bench.pairs(one.fit, list(self.sites.values())):
            size = sum(len(p.site.effect.parameters) for p in (first, second))
            name = label_of([first.site, second.site])
            if size > most or found.get(size, 0) == PAIRS or redundant(list(name)):
                continue
            found[size] = found.get(size, 0) + 1
            layer = ahead.setdefault(size, {})
            if name not in layer or first.left < layer[name].left:
                layer[name] = Ahead(one, first, second)
                self.screened[name] = first.left / self.whole
