"""From a baseline to the simplest model that predicts unseen trials as well as any: effects added while they pay.

For recordings whose noise is not known and whose best model is not exact, where information criteria keep
rewarding arbitrary terms: what is left out of a fit decides, not what is in it. The search is a beam over the
number of parameters that effects bring along; the choice among all that it met is made at the end. It was made under
weights that no noise bears out, so that descents end where they should; where the noise is stated, the choice must
gain more under it than chance would bring.

Several models may grow together: bodies of one kind, which lack the same physics, each with its own numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.candidates import contains
from spacerobot.diagnosis.data import TrialData
from spacerobot.diagnosis.hypothesis import Label
from spacerobot.diagnosis.models.bench import Bench, Promise
from spacerobot.diagnosis.models.candidate import Candidate, words
from spacerobot.diagnosis.models.chance import by_chance
from spacerobot.diagnosis.models.generals import inherited, not_excluded, wordings
from spacerobot.diagnosis.models.growth import Growth
from spacerobot.diagnosis.models.kept import Kept
from spacerobot.diagnosis.models.model import Model
from spacerobot.diagnosis.models.plausible import redundant
from spacerobot.diagnosis.models.worth import TIE, WORTH_OF_REST, choice, distinct, slack
from spacerobot.effects.effect import Effect

PATIENCE = 2
"""The search ends when so many more parameters have brought nothing that is worth naming."""

BEAM = 3
"""How many models of one size are built upon."""

TRIED = 5
"""How many models of one size, those that promise most, are fitted and tried on unseen trials."""

ANYWAY = 2
"""How many are fitted even where they promise nothing beyond what was reached: promises are linear, gaps are not."""

MOST = 6
"""Parameters that effects may bring along."""


@dataclass(frozen=True, eq=False)
class Ahead:
    """A candidate before it is fitted: what it grows from, and what each model promises."""

    near: Candidate
    promises: tuple[Promise, ...]

    @property
    def cost(self) -> float:
        """That it would come down to."""
        return sum(p.cost for p in self.promises)


def grow(
    models: Model | Sequence[Model],
    *,
    effects: Iterable[Effect] | None = None,
    most: int = MOST,
    threads: int = 1,
    say: Callable[[str], None] | None = None,
    reached: Callable[[int], None] | None = None,
    kept: Sequence[Kept] | None = None,
) -> Growth:
    """The simplest model that predicts unseen trials about as well as the best that a beam search meets.

    Args:
        models: whose baseline to begin with; several grow together.
        effects: the catalogue; all known effects if None.
        most: parameters that effects may bring along.
        threads: of the fits.
        say: told what happens.
        reached: told how many parameters the models now have that are tried.
        kept: what an earlier run had found of each model.

    Raises:
        SimulationError: the baseline cannot be fitted.
    """
    every = (models,) if isinstance(models, Model) else tuple(models)
    benches = tuple(Bench(m, threads, None if kept is None else kept[i]) for i, m in enumerate(every))
    search = _Search(benches, None if effects is None else list(effects), say or (lambda text: None))
    return search.run(most, reached or (lambda size: None))


class _Search:
    def __init__(self, benches: tuple[Bench, ...], effects: list[Effect] | None, say: Callable[[str], None]) -> None:
        self.benches = benches
        self.sites = [{s.label: s for s in b.model.sites(effects)} for b in benches]
        if len(benches) > 1:  # they share their sensors, whose faults cannot have a value for each
            self.sites = [{k: s for k, s in sites.items() if s.effect.kind != "sensor"} for sites in self.sites]
        self.say = say
        self.screened: dict[Label, float] = {}
        self.reached = np.inf

    @property
    def trials(self) -> list[TrialData]:
        """Of all models, under their present weights."""
        return [t for b in self.benches for t in b.trials]

    def run(self, most: int, reached: Callable[[int], None]) -> Growth:
        fits = [b.baseline() for b in self.benches]
        for bench, fit in zip(self.benches, fits, strict=True):
            bench.sharpen(fit)
        fits = [b.again(f) for b, f in zip(self.benches, fits, strict=True)]
        baseline = self.tested(Candidate(tuple(fits)))
        tested = [baseline]
        self.reached = baseline.cost
        ahead: dict[int, dict[Label, Ahead]] = {}
        bests: list[float] = []
        for size in range(most + 1):
            reached(size)
            bests.append(min(c.error for c in tested))
            if size > PATIENCE and bests[-1 - PATIENCE] <= slack(bests[-1], baseline.error):
                break
            best = min(c.error for c in tested) if size else np.inf
            layer = [baseline] if size == 0 else self.layer(list(ahead.pop(size, {}).values()), baseline)
            tested += layer if size else []
            layer.sort(key=lambda c: c.error)
            better = 1.0 - (TIE if size < 2 else WORTH_OF_REST)  # a pair may need two weak singles, no more
            for one in distinct([c for c in layer if c.error < better * best])[:BEAM]:
                self.look_ahead(one, most, ahead)
        tested += self.reworded(choice(tested, baseline, self.trials), tested)
        chosen = choice(tested, baseline, self.trials)
        near = [c for c in tested if c is not chosen and c is not baseline and c.simplicity <= chosen.simplicity]
        rivals = tuple(c for c in near if c.error < (1.0 + TIE) * chosen.error)
        ranked = tuple(sorted(tested, key=lambda c: c.error))
        before, after = self.weighed(chosen, baseline)
        stated = all(b.model.expected({}) for b in self.benches)
        if stated and after is not before and by_chance(before.cost - after.cost, after.size * len(self.benches)):
            self.say(f"  {words(after.label)}: no more than chance would gain under the stated noise")
            before, after = self.weighed(before, before)
            rivals = ()
        if stated and len(self.benches) == 1:
            less = self.without_chance(after, [c.label for c in tested])
            if less is not after:
                rivals = tuple(r for r in rivals if r.label != less.label and not contains(r.label, less.label))
                after = less
            more = not_excluded(self.benches[0], after.fits[0], self.sites[0])
            rivals = (*rivals, *(self.tested(Candidate((fit,))) for fit in more))
        return Growth(self.benches, before, after, rivals, ranked, tuple(self.screened.items()))

    def without_chance(self, chosen: Candidate, tried: Sequence[Label]) -> Candidate:
        """Without effects that gain no more than chance would beside the others, of sets that were tried."""
        (bench,) = self.benches
        for site in chosen.sites:
            rest = [s for s in chosen.sites if s is not site]
            if not rest or tuple(sorted(s.label for s in rest)) not in tried:
                continue
            fit = bench.fitted_as(chosen.fits[0], rest, {})
            if fit is not None and by_chance(fit.cost - chosen.cost, len(site.effect.parameters)):
                self.say(f"  {words((site.label,))}: no more than chance would gain beside the others")
                return self.without_chance(self.tested(Candidate((fit,))), tried)
        return chosen

    def weighed(self, chosen: Candidate, baseline: Candidate) -> tuple[Candidate, Candidate]:
        """Baseline and choice, fitted and tried again under the weights that what the choice leaves over asks for.

        Both were fitted under the present weights.
        """
        for bench, fit in zip(self.benches, chosen.fits, strict=True):
            bench.weigh(fit)
        before = self.tested(self.again(baseline))
        return before, before if chosen is baseline else self.tested(self.again(chosen))

    def layer(self, ahead: list[Ahead], baseline: Candidate) -> list[Candidate]:
        """The most promising candidates of one size, fitted and tried on unseen trials."""
        out: list[Candidate] = []
        bar = (1.0 - TIE) * self.reached
        for place, promise in enumerate(sorted(ahead, key=lambda p: p.cost)[: 2 * TRIED]):
            if len(out) == TRIED or (place >= ANYWAY and promise.cost > bar):
                break
            together = zip(self.benches, promise.near.fits, promise.promises, strict=True)
            fits = [bench.fitted(near, own) for bench, near, own in together]
            good = tuple(f for f in fits if f is not None)
            if len(good) == len(fits):
                one = self.tested(Candidate(good))
                self.reached = min(self.reached, one.cost)
                out.append(one)
                self.say(f"  {words(one.label)}: held-out rms x {one.error / baseline.error:.4f}")
        return out

    def reworded(self, chosen: Candidate, tested: Sequence[Candidate]) -> list[Candidate]:
        """The chosen model said with a general effect in the place of its special case and of one effect more.

        Friction and a constant force may be one friction of two levels; sensitivities at one start do not see that.
        """
        known = {c.label for c in tested}
        out = []
        for wording in wordings(chosen.sites, self.sites[0]):
            label = tuple(sorted(s.label for s, _ in wording))
            if label in known or redundant([s for s, _ in wording]):
                continue
            known.add(label)
            fits = []
            for bench, fit, sites in zip(self.benches, chosen.fits, self.sites, strict=True):
                start: dict[str, float] = {}
                for new, special in wording:
                    start |= {} if special is None else inherited(new, special, fit)
                fits.append(bench.fitted_as(fit, [sites[s.label] for s, _ in wording], start))
            good = tuple(f for f in fits if f is not None)
            if len(good) == len(fits):
                out.append(self.tested(Candidate(good)))
        return out

    def look_ahead(self, one: Candidate, most: int, ahead: dict[int, dict[Label, Ahead]]) -> None:
        """What each further effect promises to all models together."""
        further = [
            s.label
            for s in self.sites[0].values()
            if s.label not in one.label
            and one.size + len(s.effect.parameters) <= most
            and not redundant((*one.sites, s))
        ]
        found = [
            {p.site.label: p for p in bench.promises(fit, [sites[label] for label in further])}
            for bench, fit, sites in zip(self.benches, one.fits, self.sites, strict=True)
        ]
        for label in further:
            if not all(label in f for f in found):
                continue
            promise = Ahead(one, tuple(f[label] for f in found))
            name = tuple(sorted((*one.label, label)))
            layer = ahead.setdefault(one.size + len(promise.promises[0].site.effect.parameters), {})
            if name not in layer or promise.cost < layer[name].cost:
                layer[name] = promise
                self.screened[name] = promise.cost

    def again(self, one: Candidate) -> Candidate:
        """Fitted again under the present weights."""
        return Candidate(tuple(b.again(f) for b, f in zip(self.benches, one.fits, strict=True)))

    def tested(self, one: Candidate) -> Candidate:
        """Tried on unseen trials."""
        held = [b.held_out(f) for b, f in zip(self.benches, one.fits, strict=True)]
        good = tuple(h for h in held if h is not None)
        return Candidate(one.fits, good if len(good) == len(held) else ())
