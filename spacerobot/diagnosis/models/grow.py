"""From a baseline to the simplest model that predicts unseen trials as well as any: effects added while they pay.

For recordings whose noise is not known and whose best model is not exact, where information criteria keep
rewarding arbitrary terms: what is left out of a fit decides, not what is in it. The search is a beam over the
number of parameters that effects bring along; the choice among all that it met is made at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.data import TrialData
from spacerobot.diagnosis.fit import Fit, Fitter
from spacerobot.diagnosis.hypothesis import Label, Site, hypothesis
from spacerobot.diagnosis.models.held_out import HeldOut, folds, parent, predict_held_out
from spacerobot.diagnosis.models.model import Model
from spacerobot.diagnosis.models.noise import floor_of, reweighted
from spacerobot.diagnosis.models.plausible import plausible, redundant
from spacerobot.diagnosis.screen import FAINT, Screener, faint
from spacerobot.diagnosis.starts import fit_near
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

ANYWAY = 2
"""How many are fitted even where they promise nothing beyond what was reached: promises are linear, gaps are not."""

STEPS = 15
"""Gauss-Newton steps of a fit."""

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
class Promise:
    """One effect more than a fitted model has, before it is fitted itself."""

    sites: tuple[Site, ...]
    near: Fit
    start: Mapping[str, float]
    cost: float  # that it would come down to


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
        screened: cost that each set of effects promised, by its sensitivities, whether fitted then or not.
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
        self.screened: dict[Label, float] = {}
        self.reached = np.inf

    def run(self, most: int) -> Growth:
        baseline = Candidate((), self.fitter().fit(hypothesis(self.model.believed, ()), max_iterations=STEPS))
        for _ in range(2):  # weights from what the baseline leaves, then the baseline fitted under them
            baseline = self.weighed(baseline, baseline)
        baseline = self.tested(baseline)
        tested = [baseline]
        self.reached = baseline.fit.cost
        ahead: dict[int, dict[Label, Promise]] = {}
        for size in range(most + 1):
            best = min((c.error for c in tested), default=np.inf) if size else np.inf
            layer = [baseline] if size == 0 else self.layer(ahead.pop(size, {}), baseline)
            tested += layer if size else []
            layer.sort(key=lambda c: c.error)
            for one in _distinct([c for c in layer if c.error < (1.0 - TIE) * best])[:BEAM]:
                self.look_ahead(one, most, ahead)
        chosen = self.chosen(tested, baseline)
        final = self.weighed(chosen, chosen)
        before = self.tested(self.weighed(baseline, None))
        after = before if chosen is baseline else self.tested(final)
        near = [c for c in tested if c is not chosen and c.size <= chosen.size and c is not baseline]
        rivals = tuple(c for c in near if c.error < (1.0 + TIE) * chosen.error)
        ranked = tuple(sorted(tested, key=lambda c: c.error))
        return Growth(
            self.model, self.trials, before, after, rivals, ranked, tuple(self.screened.items()), self.left_out
        )

    def layer(self, promises: Mapping[Label, Promise], baseline: Candidate) -> list[Candidate]:
        """The most promising models of one size, fitted and tried on unseen trials."""
        out: list[Candidate] = []
        bar = (1.0 - TIE) * self.reached
        ranked = sorted(promises.values(), key=lambda p: p.cost)
        for place, promise in enumerate(ranked[: 2 * TRIED]):
            if len(out) == TRIED or (place >= ANYWAY and promise.cost > bar):
                break
            one = self.kept(promise)
            if one is not None:
                self.reached = min(self.reached, one.fit.cost)
                out.append(self.tested(one))
                self.say(f"  {_words(out[-1].label)}: held-out rms x {out[-1].error / baseline.error:.4f}")
        return out

    def look_ahead(self, one: Candidate, most: int, ahead: dict[int, dict[Label, Promise]]) -> None:
        """What each further effect promises, by its sensitivities at this model."""
        further = [
            s
            for s in self.sites
            if s.label not in one.label
            and one.size + len(s.effect.parameters) <= most
            and not redundant((*one.sites, s))
        ]
        screen = Screener(self.fitter(), self.model.believed).screen(one.fit, further)
        for label, item in screen.best().items():
            sites = (*one.sites, item.site)
            share = float(np.clip(FAINT * item.amplitude, -1.0, 1.0)) if item.gain > 0.0 else FAINT
            start = faint(item.site, item.start, share if abs(share) > 0.02 else float(np.copysign(0.02, share)))
            promise = Promise(sites, one.fit, start, one.fit.cost - item.gain)
            name = tuple(sorted((*one.label, label)))
            layer = ahead.setdefault(one.size + len(item.site.effect.parameters), {})
            if name not in layer or promise.cost < layer[name].cost:
                layer[name] = promise
                self.screened[name] = promise.cost

    def kept(self, promise: Promise) -> Candidate | None:
        """A promise fitted; None where it cannot be, or where the fit is no physics."""
        try:
            fit = fit_near(
                self.fitter(), self.model.believed, promise.sites, promise.near, promise.start, max_iterations=STEPS
            )
        except SimulationError:
            return None
        physical = plausible(promise.sites, fit.values(), self.model.sizes)
        return Candidate(tuple(promise.sites), fit) if physical else None

    def fitter(self) -> Fitter:
        return Fitter(self.model, self.trials, threads=self.threads)  # type: ignore[arg-type]

    def weighed(self, one: Candidate, judge: Candidate | None) -> Candidate:
        """Fitted again, with the weights that a judge's residual asks for; with the present ones if None."""
        if judge is not None:
            residuals = {k: t.residual for k, t in judge.fit.trials.items()}
            self.trials = reweighted(self.trials, floor_of(residuals, self.trials))
        fit = one.fit
        again = self.fitter().fit(fit.hypothesis, warm=fit.values(), initials=fit.initials(), max_iterations=STEPS)
        return Candidate(one.sites, again)

    def tested(self, one: Candidate) -> Candidate:
        made, values, initials = one.fit.hypothesis, one.fit.values(), one.fit.initials()
        try:
            held = predict_held_out(self.model, self.trials, made, values, self.left_out, initials)
        except SimulationError:
            return one
        return Candidate(one.sites, one.fit, held)

    def chosen(self, tested: Sequence[Candidate], baseline: Candidate) -> Candidate:
        """The simplest that predicts as well as the best does, as far as a further parameter is worth naming."""
        good = [c for c in tested if self.pays(c, baseline)]
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
