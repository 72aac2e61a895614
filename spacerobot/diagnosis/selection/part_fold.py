"""Trials kept aside: decided again without them, and then they are predicted.

In each fold the part's model has the other trials alone. From these come starts, weights and the choice among the sets
in play: the chosen one, its parts and its nearest rivals, each grown from the fold's own baseline and tried by the same
rules (`forward_selection.py`), on parts of these trials that are left out in turn. Of an unseen trial only its own
start is taken from its readings. The part's typical sizes, by which steps of a fit are scaled, are those of all
recordings.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.noise import reweighted, split
from spacerobot.diagnosis.machines.machine import Model
from spacerobot.diagnosis.machines.simulated import Simulated
from spacerobot.diagnosis.machines.windows import FOLDS
from spacerobot.diagnosis.selection.bench import STEPS, Bench
from spacerobot.diagnosis.selection.check import Check
from spacerobot.diagnosis.selection.forward_selection import among
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.model_choice import TIE, ratio
from spacerobot.diagnosis.selection.part_held_out import HeldOut, folds, start_of
from spacerobot.diagnosis.selection.unseen import NOT_FITTED, nothing_foretold
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Label, Site
from spacerobot.diagnosis.terms.kinds import OPEN, OTHER, PART, SAME, TOLD, LeadsTo, Told
from spacerobot.support.errors import SimulationError

MOST_FOLDS = 6
"""Conditions, or trials, that are kept aside one by one; of more, so many groups are in turn."""

INNER = 4
"""Into how many groups the others are divided at most, for what they choose."""

RIVALS = 2
"""Sets nearest to the chosen one that each fold chooses among, beside those that are not told apart."""


@dataclass(frozen=True)
class PartFold:
    """What was kept aside, and what the other trials say.

    Attributes:
        out: ids of the trials kept aside.
        selected: the set that the others lead to.
        leads_to: what that is to the set chosen on all trials.
        failed: (trial, model, why) of what could not be predicted.
    """

    out: tuple[str, ...]
    selected: Label
    leads_to: LeadsTo
    failed: tuple[tuple[str, Told, str], ...] = ()


@dataclass(frozen=True, eq=False)
class Unseen:
    """How well trials are predicted by what was decided without them.

    Attributes:
        folds: what each led to.
        before, after, selected: prediction errors, of the baseline, of the set chosen on all trials and of each fold's.
    """

    folds: tuple[PartFold, ...]
    before: HeldOut
    after: HeldOut
    selected: HeldOut

    def count(self, *what: str) -> int:
        """Folds that lead to such a set."""
        return sum(f.leads_to in what for f in self.folds)

    def check(self, name: str) -> Check:
        """Whether effects may be named, as far as unseen trials tell; see `held_out.HeldOut.check` of the wrist rig."""
        count, other = len(self.folds), self.count(OTHER)
        said = f"without a part of the trials {self.count(SAME)} of {count} times the same set is chosen"
        if 2 * other > count:
            said = f"without a part of the trials {other} of {count} times another set is chosen"
            strays = [t for f in self.folds if f.leads_to == OTHER for t in f.out]
            if not self._better(strays, self.selected):  # several sets say the same of much that is left unexplained
                return Check(f"held out, {name}", False, said)
            said += ", which predicts what was kept aside worse"
        every = list(self.after.residual)
        telling = [t for f in self.folds if f.leads_to in (SAME, OPEN) for t in f.out] or every
        better = self._better(every) or self._better(telling)  # others may have seen too little of it to foretell it
        if not better:
            said += ", and it predicts trials that were kept aside no better than the baseline"
        return Check(f"held out, {name}", better, said)

    def _better(self, trials: Sequence[str], than: HeldOut | None = None) -> bool:
        """Whether the chosen set predicts these trials better, than the baseline if nothing else is said."""
        both = (than or self.before, self.after)
        other, after = (sum(float(h.residual[t] @ h.residual[t]) for t in trials) for h in both)
        return after < other


def keep_aside(growth: Growth) -> Unseen:
    """Every trial of a part predicted by what was decided without it."""
    bench = growth.bench
    done: list[PartFold] = []
    told: dict[str, dict[str, np.ndarray]] = {name: {} for name in TOLD}
    counted: dict[str, dict[str, np.ndarray]] = {name: {} for name in TOLD}
    for _, out in folds(bench.model.trials, MOST_FOLDS):
        fold, residuals = decided_without(growth, out)
        done.append(fold)
        for name in TOLD:
            for trial, (row, keep) in residuals[name].items():
                told[name][trial], counted[name][trial] = row, keep
    return Unseen(tuple(done), *(HeldOut(told[name], counted[name]) for name in TOLD))


Rows = Mapping[str, tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True, eq=False)
class Decided:
    """What some of the trials lead to.

    Attributes:
        growth: among the sets in play.
        weights: by channel, what the model's own weights are divided by.
        fits: of TOLD, to these trials; None where it could not be fitted.
    """

    growth: Growth
    weights: Mapping[str, float]
    fits: Mapping[str, Fit | None]


def decided(growth: Growth, out: Sequence[str]) -> Decided:
    """All that is fitted and chosen without some trials, of the sets in play.

    Raises:
        SimulationError: the baseline cannot be fitted to the others, or there are none.
    """
    whole, sites = growth.bench, {s.label: s for s in growth.sites}
    rest = but_for(whole.model, out)
    if not rest.trials:
        raise SimulationError("nothing is left to fit when a fold is left out")
    bench = Bench(divided(rest), whole.threads, whole.kept.within(f"without {', '.join(out)}"), most=INNER)
    own, again = among(bench, [sites[one] for one in growth.after.label], _in_play(growth, sites))
    fits = {"before": own.before.fit, "after": again, "selected": own.after.fit}
    if bench.model is not rest:
        fitter = Fitter(rest, reweighted(rest.trials, bench.weights))
        fits = {name: None if fit is None else _undivided(fitter, fit) for name, fit in fits.items()}
    return Decided(own, bench.weights, fits)


def _undivided(fitter: Fitter, fit: Fit) -> Fit:
    """A fit to parts of a trial, to the whole of it; as it was where that cannot be."""
    with contextlib.suppress(SimulationError):
        return fitter.fit(fit.hypothesis, warm=fit.values(), max_iterations=STEPS, robust=False)
    return fit


def decided_without(growth: Growth, out: Sequence[str]) -> tuple[PartFold, dict[str, Rows]]:
    """One fold: what the other trials lead to, and by TOLD and trial the errors, weighted as the part's are."""
    whole, chosen = growth.bench, growth.after.label
    unseen = [t for t in whole.model.trials if t.id in out]
    rows: dict[str, Rows] = {}
    missed: list[tuple[str, Told, str]] = []
    try:
        said = decided(growth, out)
    except SimulationError as error:
        for name in TOLD:
            rows[name], failed = _rows(whole, {}, None, unseen, str(error))
            missed += [(trial, name, why) for trial, why in failed.items()]
        return PartFold(tuple(out), (), OTHER, tuple(missed)), rows
    for name in TOLD:
        rows[name], failed = _rows(whole, said.weights, said.fits[name], unseen, NOT_FITTED)
        missed += [(trial, name, why) for trial, why in failed.items()]
    best = said.growth.after.label
    leads_to: LeadsTo
    if best == chosen:
        leads_to = SAME
    elif contains(chosen, best):
        leads_to = PART
    else:
        leads_to = OPEN if _as_well(said.growth, chosen) else OTHER
    return PartFold(tuple(out), best, leads_to, tuple(missed)), rows


def _as_well(own: Growth, chosen: Label) -> bool:
    """Whether a set predicts as well as what the fold has chosen, on parts of the fold's own trials.

    Friction of two levels is a constant force beside friction of one, in other words.
    """
    tried = {c.label: c for c in own.considered}
    return chosen in tried and ratio(tried[chosen], tried[own.after.label]) < 1.0 + TIE


def but_for(model: Model, out: Sequence[str]) -> Model:
    """The model with its other trials alone."""
    if isinstance(model, Simulated):
        return model.but_for(out)
    other = copy(model)
    other.trials = tuple(t for t in model.trials if t.id not in out)
    return other


def divided(model: Model) -> Model:
    """The model, where there is but one trial left, with that in parts: a choice needs something to try itself on."""
    if isinstance(model, Simulated) and len(model.trials) == 1:
        (trial,) = model.trials
        return model.in_windows((trial.end - trial.start) / FOLDS)
    return model


def _in_play(growth: Growth, sites: Mapping[tuple[str, str], Site]) -> list[list[Site]]:
    """Sets that were not told apart from the chosen one, and those that came nearest to it without holding it."""
    chosen = growth.after.label
    open_to = [r.label for r in growth.rivals]
    near = [c.label for c in growth.considered if c.sites and c.label not in (chosen, *open_to, *growth.refused)]
    near = [label for label in near if not chosen or not contains(label, chosen)]
    return [[sites[one] for one in label] for label in dict.fromkeys([*open_to, *near[:RIVALS]])]


def _rows(
    whole: Bench, weights: Mapping[str, float], fit: Fit | None, unseen: Sequence[TrialData], why: str
) -> tuple[Rows, dict[str, str]]:
    """Errors of unseen trials by a fit to others, weighted as all trials are now; and which could not be predicted."""
    model, now = whole.model, {t.id: t for t in whole.trials}
    out: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    failed: dict[str, str] = {}
    for trial, plain in zip(reweighted(unseen, weights), unseen, strict=True):
        try:
            if fit is None:
                raise SimulationError(why)
            fitter = Fitter(model, [trial])
            start = start_of(fitter, model, fit.hypothesis, fit.z, trial)
            raw, keep = fitter.residual(fit.hypothesis, fit.z, trial, start)
            by = {c: (weights.get(c) or 1.0) / (whole.weights.get(c) or 1.0) for c in trial.channels}
            scale = np.concatenate([np.full(part.size, by[c]) for c, part in split(raw, trial).items()])
            out[plain.id] = np.where(keep, raw * scale, 0.0), keep
        except SimulationError as error:
            failed[plain.id] = str(error)
            row = nothing_foretold(now[plain.id])
            good = np.concatenate([(b.weight > 0.0).ravel() for b in plain.blocks])
            out[plain.id] = row, good
    return out, failed
