"""From a baseline to the simplest model that predicts unseen trials as well as any: effects added while they pay.

For recordings whose noise is not known and whose best model is not exact, where information criteria keep
rewarding arbitrary terms: what is left out of a fit decides, not what is in it. The search is a beam over the
number of parameters that effects bring along; the choice among all that it met is made at the end. It was made under
weights that no noise bears out, so that descents end where they should; where the noise is stated, the choice must
gain more under it than chance would bring.

Several models may grow together: bodies of one kind, which lack the same physics, each with its own numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.hypothesis import Label, Site
from spacerobot.diagnosis.models.bench import Bench, Promise
from spacerobot.diagnosis.models.chance import by_chance
from spacerobot.diagnosis.models.generals import general_sites, inherited, not_excluded
from spacerobot.diagnosis.models.held_out import HeldOut, parent
from spacerobot.diagnosis.models.kept import Kept
from spacerobot.diagnosis.models.model import Model
from spacerobot.diagnosis.models.plausible import redundant
from spacerobot.effects.effect import Effect

WORTH_OF_REST = 0.05
WORTH_OF_BASELINE = 0.02
"""A further parameter must lower the held-out rms by these shares of itself and of the baseline's: an effect size,
for in long recordings any harmless defect is significant."""

SURE = 0.95
"""Probability, by Student's t, with which the mean gain over unseen trials must exceed zero."""

TELLING = 0.1
"""Change of the logarithm of the mean square below which a piece tells nothing: there both models are at the noise."""

CLEAR = 3.0
"""Standard errors by which a body's own value differs from nothing, where several grow together."""

PATIENCE = 2
"""The search ends when so many more parameters have brought nothing that is worth naming."""

TIE = 0.01
"""Rivals whose held-out rms differ by less than this share are not told apart."""

SAME = 1e-4
"""Candidates of one size whose held-out rms agree to this share are one model in two wordings."""

BEAM = 3
"""How many models of one size are built upon."""

TRIED = 5
"""How many models of one size, those that promise most, are fitted and tried on unseen trials."""

ANYWAY = 2
"""How many are fitted even where they promise nothing beyond what was reached: promises are linear, gaps are not."""

MOST = 6
"""Parameters that effects may bring along."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A baseline with effects in it: how it fits, and how it predicts.

    Attributes:
        fits: to all trials, one a model.
        held_out: on unseen trials, one a model; empty where that was not tried.
    """

    fits: tuple[Fit, ...]
    held_out: tuple[HeldOut, ...] = ()

    @property
    def sites(self) -> tuple[Site, ...]:
        """Effects and places."""
        return self.fits[0].hypothesis.sites

    @property
    def label(self) -> Label:
        """Which effects where."""
        return self.fits[0].hypothesis.label

    @property
    def size(self) -> int:
        """Number of parameters that the effects bring along."""
        return sum(len(s.effect.parameters) for s in self.sites)

    @property
    def simplicity(self) -> tuple[int, int]:
        """(parameters, effects): of two models that predict alike, the one with less of both is meant."""
        return self.size, len(self.sites)

    @property
    def cost(self) -> float:
        """Of the fits together."""
        return sum(f.cost for f in self.fits)

    @property
    def error(self) -> float:
        """Weighted rms on unseen trials; infinite where it was not tried."""
        if not self.held_out:
            return np.inf
        return float(np.sqrt(np.mean([h.mean_square for h in self.held_out])))


@dataclass(frozen=True, eq=False)
class Ahead:
    """A candidate before it is fitted: what it grows from, and what each model promises."""

    near: Candidate
    promises: tuple[Promise, ...]

    @property
    def cost(self) -> float:
        """That it would come down to."""
        return sum(p.cost for p in self.promises)


@dataclass(frozen=True, eq=False)
class Growth:
    """What was found.

    Attributes:
        benches: the models, with their trials under the weights that the chosen model asks for.
        before: the baseline.
        after: the chosen candidate; the baseline where nothing pays.
        rivals: candidates of no more parameters, in no more effects, that predict as well; and those with a general
            effect for a special case that stated noise does not exclude.
        considered: every candidate that was tried on unseen trials, best first.
        screened: cost that each set of effects promised, by its sensitivities, whether fitted then or not.
    """

    benches: tuple[Bench, ...]
    before: Candidate
    after: Candidate
    rivals: tuple[Candidate, ...]
    considered: tuple[Candidate, ...]
    screened: tuple[tuple[Label, float], ...]

    @property
    def considered_baseline(self) -> Candidate:
        """The baseline under the weights of the search, as the candidates beside it."""
        return next(c for c in self.considered if not c.sites)

    def rms(self, which: int = 0) -> tuple[dict[str, float], dict[str, float]]:
        """Held-out rms of one model by channel, in the channels' units: of the baseline and as chosen."""
        trials = self.benches[which].trials
        return self.before.held_out[which].rms(trials), self.after.held_out[which].rms(trials)

    def needs(self, which: int = 0) -> bool:
        """Whether this model itself predicts unseen trials better as chosen than as believed."""
        before, after = (np.sqrt(c.held_out[which].mean_square) for c in (self.before, self.after))
        fit = self.after.fits[which]
        effects = [i for i, f in enumerate(fit.hypothesis.free) if f.kind == "effect"]
        if not effects or fit.covariance is None or not after < (1.0 - WORTH_OF_REST) * before:
            return False
        null = np.array([fit.hypothesis.free[i].z(_null(fit, i)) for i in effects])
        sigma = np.sqrt(np.maximum(np.diag(fit.covariance)[effects], 0.0))
        apart = np.abs(fit.z[effects] - null)
        return bool((apart > CLEAR * sigma)[apart > 0.0].any())


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
            for one in _distinct([c for c in layer if c.error < better * best])[:BEAM]:
                self.look_ahead(one, most, ahead)
        tested += self.reworded(self.chosen(tested, baseline), tested)
        chosen = self.chosen(tested, baseline)
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
            more = not_excluded(self.benches[0], after.fits[0], self.sites[0])
            rivals = (*rivals, *(self.tested(Candidate((fit,))) for fit in more))
        return Growth(self.benches, before, after, rivals, ranked, tuple(self.screened.items()))

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
        for wording in _wordings(chosen.sites, self.sites[0]):
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

    def chosen(self, tested: Sequence[Candidate], baseline: Candidate) -> Candidate:
        """The simplest that predicts as well as the best does, as far as a further parameter is worth naming."""
        good = [c for c in tested if self.pays(c, baseline)]
        if not good:
            return baseline
        best = min(c.error for c in good)
        near = [c for c in good if c.error <= slack(best, baseline.error)]
        simplest = min(c.size for c in near)
        first = min(c.error for c in near if c.size == simplest)
        same = [c for c in near if c.size == simplest and c.error <= (1.0 + SAME) * first]
        return min(same, key=lambda c: (sum(s.effect.kind == "sensor" for s in c.sites), len(c.sites), c.error))

    def pays(self, new: Candidate, old: Candidate) -> bool:
        """Whether unseen trials are predicted better, by enough and throughout."""
        if not new.held_out or not old.held_out or not new.error < (1.0 - WORTH_OF_REST) * old.error:
            return False
        before = {k: v for h in old.held_out for k, v in h.squares().items()}
        after = {k: v for h in new.held_out for k, v in h.squares().items()}
        trials = [t for b in self.benches for t in b.trials]
        by_parent = len({parent(t) for t in trials}) > 3
        groups: dict[str, list[float]] = {}
        for trial in trials:
            gain = np.log(max(before[trial.id], 1e-300) / max(after[trial.id], 1e-300))
            groups.setdefault(parent(trial) if by_parent else trial.id, []).append(float(gain))
        gains = np.array([np.mean(g) for g in groups.values()])
        gains = gains[np.abs(gains) > TELLING]
        if gains.size < 3:
            return bool(gains.size and (gains > 0.0).all())
        return bool(gains.mean() > stdtrit(gains.size - 1, SURE) * gains.std(ddof=1) / np.sqrt(gains.size))


def slack(best: float, baseline: float) -> float:
    """The largest held-out rms of a model that is as good as the best one."""
    return max(best / (1.0 - WORTH_OF_REST), best + WORTH_OF_BASELINE * baseline)


def _distinct(layer: Sequence[Candidate]) -> list[Candidate]:
    """Without those that say the same as one before them in other words (a preload and a bias of its sensor)."""
    kept: list[Candidate] = []
    for one in layer:
        if all(abs(one.error - k.error) > SAME * k.error for k in kept):
            kept.append(one)
    return kept


def _wordings(
    chosen: Sequence[Site], known: Mapping[tuple[str, str], Site]
) -> Iterator[list[tuple[Site, Site | None]]]:
    """Sets with as many parameters in which a general effect stands for its special case and others.

    Yields:
        The sites, each with the special case that it stands for, or None.
    """
    for special in chosen:
        for new in general_sites(special, known):
            spare = len(new.effect.parameters) - len(special.effect.parameters)
            rest = [s for s in chosen if s is not special]
            for left_out in rest:
                if len(left_out.effect.parameters) == spare:
                    yield [(new, special), *((s, None) for s in rest if s is not left_out)]


def _null(fit: Fit, index: int) -> float:
    """The value of an effect's parameter at which it does nothing."""
    key = fit.hypothesis.free[index].key
    for site in fit.hypothesis.sites:
        for parameter in site.effect.parameters:
            if site.key(parameter.name) == key:
                return parameter.null if np.isfinite(parameter.null) else parameter.upper
    raise AssertionError(key)


def words(label: Label) -> str:
    """A set of effects in words, for progress and tables."""
    return " + ".join(f"{effect}@{where}" for effect, where in label) or "baseline"
