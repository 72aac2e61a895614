"""From a baseline to the simplest model that predicts unseen trials as well as any: effects added while they pay.

For recordings whose noise is not known and whose best model is not exact, where information criteria keep
rewarding arbitrary terms: what is left out of a fit decides, not what is in it. The search is a beam over the
number of parameters that effects bring along; the choice among all that it met is made at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.data import TrialData
from spacerobot.diagnosis.fit import Fit, Fitter
from spacerobot.diagnosis.hypothesis import Label, Site, hypothesis
from spacerobot.diagnosis.models.held_out import HeldOut, folds, parent, predict_held_out
from spacerobot.diagnosis.models.model import Model
from spacerobot.diagnosis.models.noise import floor_of, reweighted
from spacerobot.diagnosis.models.plausible import plausible, redundant
from spacerobot.diagnosis.starts import effect_starts
from spacerobot.effects.effect import Effect
from spacerobot.support.errors import SimulationError

WORTH_OF_REST = 0.05
WORTH_OF_BASELINE = 0.02
"""A further parameter must lower the held-out rms by these shares of itself and of the baseline's: an effect size,
for in long recordings any harmless defect is significant."""

SURE = 2.0
"""Standard errors by which the mean gain over unseen trials must exceed zero."""

TIE = 0.01
"""Rivals whose held-out rms differ by less than this share are not told apart."""

SAME = 1e-4
"""Candidates of one size whose held-out rms agree to this share are one model in two wordings."""

BEAM = 3
"""How many models of one size are built upon."""

TRIED = 5
"""How many models of one size, those that fit best, are fitted to the end and tried on unseen trials."""

ROUGH = 3
"""Gauss-Newton steps that a candidate gets before it is compared with others of its size."""

MOST = 6
"""Parameters that effects may bring along."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A baseline with effects in it: how it fits, and how it predicts.

    Attributes:
        sites: effects and places.
        fit: to all trials.
        held_out: on unseen trials; None where that was not tried.
    """

    sites: tuple[Site, ...]
    fit: Fit
    held_out: HeldOut | None = None

    @property
    def label(self) -> Label:
        """Which effects where."""
        return self.fit.hypothesis.label

    @property
    def size(self) -> int:
        """Number of parameters that the effects bring along."""
        return sum(len(s.effect.parameters) for s in self.sites)

    @property
    def error(self) -> float:
        """Weighted rms on unseen trials; infinite where it was not tried."""
        return np.inf if self.held_out is None else float(np.sqrt(self.held_out.mean_square))


@dataclass(frozen=True, eq=False)
class Growth:
    """What was found.

    Attributes:
        model: which.
        trials: with weights from what the chosen model leaves.
        before: the baseline.
        after: the chosen model; the baseline where nothing pays.
        rivals: models of the same size that predict as well.
        considered: every model that was tried on unseen trials, best first.
        screened: labels of those that were only fitted, with their chi-squared.
        left_out: the folds.
    """

    model: Model
    trials: tuple[TrialData, ...]
    before: Candidate
    after: Candidate
    rivals: tuple[Candidate, ...]
    considered: tuple[Candidate, ...]
    screened: tuple[tuple[Label, float], ...]
    left_out: tuple[tuple[str, tuple[str, ...]], ...]

    def rms(self) -> tuple[dict[str, float], dict[str, float]]:
        """Held-out rms by channel, in the channels' units: of the baseline and of the chosen model."""
        assert self.before.held_out is not None
        assert self.after.held_out is not None
        return self.before.held_out.rms(self.trials), self.after.held_out.rms(self.trials)


def grow(
    model: Model,
    *,
    effects: Iterable[Effect] | None = None,
    most: int = MOST,
    threads: int = 1,
    say: Callable[[str], None] | None = None,
) -> Growth:
    """The simplest model that predicts unseen trials about as well as the best that a beam search meets.

    Args:
        model: whose baseline to begin with.
        effects: the catalogue; all known effects if None.
        most: parameters that effects may bring along.
        threads: of the fits.
        say: told what happens.

    Raises:
        SimulationError: the baseline cannot be fitted, or its prediction not be made.
    """
    return _Search(model, tuple(model.sites(effects)), threads, say or (lambda text: None)).run(most)


class _Search:
    def __init__(self, model: Model, sites: tuple[Site, ...], threads: int, say: Callable[[str], None]) -> None:
        self.model, self.sites, self.threads, self.say = model, sites, threads, say
        self.trials = model.trials
        self.left_out = tuple(folds(model.trials))

    def run(self, most: int) -> Growth:
        baseline = self.fitted((), {})
        for _ in range(2):  # weights from what the baseline leaves, then the baseline fitted under them
            baseline = self.weighed(baseline, baseline)
        baseline = self.tested(baseline)
        tested = [baseline]
        rough: dict[int, dict[Label, Candidate]] = {}
        for size in range(most + 1):
            here = [c for c in rough.pop(size, {}).values() if plausible(c.sites, c.fit.values(), self.model.sizes)]
            for one in sorted(here, key=lambda c: c.fit.cost)[:TRIED]:
                tested.append(self.tested(self.fitted(one.sites, one.fit.values(), one.fit)))
                self.say(f"  {_words(tested[-1].label)}: held-out rms x {tested[-1].error / baseline.error:.4f}")
            best = min(c.error for c in tested if c.size < size) if size else np.inf
            layer = [c for c in tested if c.size == size and plausible(c.sites, c.fit.values(), self.model.sizes)]
            layer.sort(key=lambda c: c.error)
            for one in _distinct([c for c in layer if c.error < (1.0 - TIE) * best])[:BEAM]:
                for site in self.sites:
                    fits = site.label not in one.label and one.size + len(site.effect.parameters) <= most
                    if fits and not redundant((*one.sites, site)):
                        self.extend(one, site, rough)
        chosen = self.chosen(tested, baseline)
        final = self.weighed(chosen, chosen)
        before = self.tested(self.weighed(baseline, None))
        after = before if chosen is baseline else self.tested(final)
        near = [c for c in tested if c is not chosen and c.size <= chosen.size and c is not baseline]
        near = [c for c in near if plausible(c.sites, c.fit.values(), self.model.sizes)]
        rivals = tuple(c for c in near if c.error < (1.0 + TIE) * chosen.error)
        left = tuple((label, c.fit.chi2) for layer in rough.values() for label, c in layer.items())
        ranked = tuple(sorted(tested, key=lambda c: c.error))
        return Growth(self.model, self.trials, before, after, rivals, ranked, left, self.left_out)

    def extend(self, one: Candidate, site: Site, rough: dict[int, dict[Label, Candidate]]) -> None:
        """One more site, fitted roughly from each of its starts; the best is kept."""
        for start in effect_starts([site]):
            try:
                new = self.fitted((*one.sites, site), {**one.fit.values(), **start}, one.fit, ROUGH)
            except SimulationError:
                continue
            layer = rough.setdefault(new.size, {})
            if new.label not in layer or new.fit.cost < layer[new.label].fit.cost:
                layer[new.label] = new

    def fitted(
        self, sites: Sequence[Site], start: dict[str, float], warm: Fit | None = None, steps: int = 30
    ) -> Candidate:
        made = hypothesis(self.model.believed, sites, start)
        known = {k: v for k, v in start.items() if k in made.keys}
        initials = None if warm is None else warm.initials()
        fitter = Fitter(self.model, self.trials, threads=self.threads)  # type: ignore[arg-type]
        return Candidate(tuple(sites), fitter.fit(made, warm=known, initials=initials, max_iterations=steps))

    def weighed(self, one: Candidate, judge: Candidate | None) -> Candidate:
        """Fitted again, with the weights that a judge's residual asks for; with the present ones if None."""
        if judge is not None:
            residuals = {k: t.residual for k, t in judge.fit.trials.items()}
            self.trials = reweighted(self.trials, floor_of(residuals, self.trials))
        return self.fitted(one.sites, one.fit.values(), one.fit)

    def tested(self, one: Candidate) -> Candidate:
        made, values, initials = one.fit.hypothesis, one.fit.values(), one.fit.initials()
        try:
            held = predict_held_out(self.model, self.trials, made, values, self.left_out, initials)
        except SimulationError:
            return one
        return Candidate(one.sites, one.fit, held)

    def chosen(self, tested: Sequence[Candidate], baseline: Candidate) -> Candidate:
        """The simplest that predicts as well as the best does, as far as a further parameter is worth naming."""
        sizes = self.model.sizes
        good = [c for c in tested if plausible(c.sites, c.fit.values(), sizes) and self.pays(c, baseline)]
        if not good:
            return baseline
        best = min(c.error for c in good)
        slack = max(best / (1.0 - WORTH_OF_REST), best + WORTH_OF_BASELINE * baseline.error)
        near = [c for c in good if c.error <= slack]
        simplest = min(c.size for c in near)
        first = min(c.error for c in near if c.size == simplest)
        same = [c for c in near if c.size == simplest and c.error <= (1.0 + SAME) * first]
        return min(same, key=lambda c: (sum(s.effect.kind == "sensor" for s in c.sites), len(c.sites)))

    def pays(self, new: Candidate, old: Candidate) -> bool:
        """Whether unseen trials are predicted better, by enough and throughout."""
        if new.held_out is None or old.held_out is None or not new.error < (1.0 - WORTH_OF_REST) * old.error:
            return False
        before, after = old.held_out.squares(), new.held_out.squares()
        by_parent = len({parent(t) for t in self.trials}) > 3
        groups: dict[str, list[float]] = {}
        for trial in self.trials:
            gain = np.log(max(before[trial.id], 1e-300) / max(after[trial.id], 1e-300))
            groups.setdefault(parent(trial) if by_parent else trial.id, []).append(float(gain))
        gains = np.array([np.mean(g) for g in groups.values()])
        if gains.size < 3:
            return bool((gains > 0.0).all())
        return bool(gains.mean() > SURE * gains.std(ddof=1) / np.sqrt(gains.size))


def _distinct(layer: Sequence[Candidate]) -> list[Candidate]:
    """Without those that say the same as one before them in other words (a preload and a bias of its sensor)."""
    kept: list[Candidate] = []
    for one in layer:
        if all(abs(one.error - k.error) > SAME * k.error for k in kept):
            kept.append(one)
    return kept


def _words(label: Label) -> str:
    return " + ".join(f"{effect}@{where}" for effect, where in label) or "baseline"
