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
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.noise import reweighted, split
from spacerobot.diagnosis.selection.bench import STEPS, Bench
from spacerobot.diagnosis.selection.forward_selection import among, no_larger
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.held_out import MOST_FOLDS, HeldOut, folds, scheme_of, start_of
from spacerobot.diagnosis.selection.kept_aside import Fold, Unseen
from spacerobot.diagnosis.selection.model_choice import ratio
from spacerobot.diagnosis.selection.unseen import NOT_FITTED, nothing_foretold
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.decision import TIE
from spacerobot.diagnosis.terms.hypothesis import Label, Site
from spacerobot.diagnosis.terms.kinds import OPEN, OTHER, PART, SAME, TOLD, LeadsTo, Told
from spacerobot.support.errors import SimulationError

INNER = 4
"""Into how many groups the others are divided at most, for what they choose."""

RIVALS = 2
"""Sets nearest to the chosen one that each fold chooses among, beside those that are not told apart."""


def settled(growth: Growth) -> tuple[Growth, Unseen]:
    """The choice, and its trials kept aside; less than was chosen where these say so.

    Where most folds choose but a part of the set, and by that foretell what was kept aside better than the whole set
    does, the rest of it was fitted to the trials, not found in them. What no fold finds any of, and what
    is foretold about as well without, is not there.
    """
    unseen = keep_aside(growth)
    as_well = unseen.after.together > (1.0 - TIE) * unseen.before.together
    if growth.after.size and as_well and not any(f.selected for f in unseen.folds) and not unseen.leading_to(OPEN):
        return settled(no_larger(growth, 0, "is not found without a part of the trials, whichever"))
    found = unseen.leading_to(PART)
    sizes = [size for f in found if 0 < (size := growth.size_of(f.selected)) < growth.after.size]
    better = unseen.selected.together < (1.0 - TIE) * unseen.after.together
    if not better or 2 * len(sizes) <= len(unseen.folds):
        return growth, unseen
    return settled(no_larger(growth, max(sizes), "foretells trials worse than what is chosen without them"))


def keep_aside(growth: Growth) -> Unseen:
    """Every trial of a part predicted by what was decided without it."""
    trials = growth.bench.model.trials
    done = [decided_without(growth, out) for _, out in folds(trials, MOST_FOLDS)]
    before, after, selected = (joined([by[name] for _, by in done]) for name in TOLD)
    own = ["each piece's own start, from its readings and the sensor's noise"]
    shaped = (s for s in growth.after.sites if s.effect.together and s.effect.settings)
    own += [f"{', '.join(s.effect.settings)} of {s.effect.phrase}, which all trials tell" for s in shaped]
    scheme, kept = scheme_of(trials, MOST_FOLDS), tuple(fold for fold, _ in done)
    or_values = growth.by_values is not None
    return Unseen(scheme, kept, before, after, selected, taken=tuple(own), or_values=or_values)


def joined(parts: Sequence[HeldOut]) -> HeldOut:
    """Of the trials of all."""
    columns = zip(*(vars(p).values() for p in parts), strict=True)
    return HeldOut(*({k: v for told in column for k, v in told.items()} for column in columns))


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
    rest = whole.model.but_for(out)
    if not rest.trials:
        raise SimulationError("nothing is left to fit when a fold is left out")
    bench = Bench(rest.divided(), whole.threads, whole.kept.within(f"without {', '.join(out)}"), most=INNER)
    own, again = among(bench, [sites[one] for one in growth.after.label], _in_play(growth, sites))
    after = _begun_at(bench, own, growth, again)
    same = own.after.label == growth.after.label
    fits = {"before": own.before.fit, "after": after, "selected": after if same else own.after.fit}
    if bench.model is not rest:
        fitter = Fitter(rest, reweighted(rest.trials, bench.weights))
        fits = {name: None if fit is None else _undivided(fitter, fit) for name, fit in fits.items()}
    return Decided(own, bench.weights, fits)


def _begun_at(bench: Bench, own: Growth, growth: Growth, again: Fit | None) -> Fit | None:
    """The chosen set fitted to the fold's trials, grown from its own baseline or begun at what all trials led to.

    The better of the two: where a law has several minima, the one at which a fit ends says nothing of the trials.
    """
    values = {k: v for k, v in growth.after.fit.values().items() if "@" in k}
    if not values:
        return again
    other = bench.fitted_as(own.before.fit, growth.after.fit.hypothesis.sites, values)
    return other if other is not None and (again is None or other.cost < (1.0 - TIE) * again.cost) else again


def _undivided(fitter: Fitter, fit: Fit) -> Fit:
    """A fit to parts of a trial, to the whole of it; as it was where that cannot be."""
    with contextlib.suppress(SimulationError):
        return fitter.fit(fit.hypothesis, warm=fit.values(), max_iterations=STEPS, robust=False)
    return fit


def decided_without(growth: Growth, out: Sequence[str]) -> tuple[Fold, Mapping[Told, HeldOut]]:
    """One fold: what the other trials lead to, and by TOLD the errors of those left out, weighted as the part's are."""
    whole, chosen = growth.bench, growth.after.label
    unseen = [t for t in whole.model.trials if t.id in out]
    try:
        said = decided(growth, out)
    except SimulationError as error:
        nothing = errors_of(whole, {}, None, unseen, str(error))
        return Fold(tuple(out), (), OTHER), dict.fromkeys(TOLD, nothing)
    told = {name: errors_of(whole, said.weights, said.fits[name], unseen, NOT_FITTED) for name in TOLD}
    best = said.growth.after.label
    leads_to: LeadsTo
    if best == chosen:
        leads_to = SAME
    elif contains(chosen, best):
        leads_to = PART
    else:
        rival = any(best == r.label for r in growth.rivals)
        leads_to = OPEN if rival or _as_well(said.growth, chosen) else OTHER
    return Fold(tuple(out), best, leads_to), told


def _as_well(own: Growth, chosen: Label) -> bool:
    """Whether a set predicts as well as what the fold has chosen, on parts of the fold's own trials.

    Friction of two levels is a constant force beside friction of one, in other words.
    """
    tried = {c.label: c for c in own.considered}
    return chosen in tried and ratio(tried[chosen], tried[own.after.label]) < 1.0 + TIE


def _in_play(growth: Growth, sites: Mapping[tuple[str, str], Site]) -> list[list[Site]]:
    """Sets that were not told apart from the chosen one, and those that came nearest to it and say no more."""
    chosen, most = growth.after.label, max(growth.after.size, 1)
    open_to = [r.label for r in growth.rivals]
    near = [c.label for c in growth.considered if c.sites and c.size <= most]
    near = [label for label in near if label not in (chosen, *open_to, *growth.refused)]
    return [[sites[one] for one in label] for label in dict.fromkeys([*open_to, *near[:RIVALS]])]


def errors_of(
    whole: Bench, weights: Mapping[str, float], fit: Fit | None, unseen: Sequence[TrialData], why: str
) -> HeldOut:
    """Errors of unseen trials by a fit to others, weighted as all trials are now; and which could not be predicted."""
    model, now = whole.model, {t.id: t for t in whole.trials}
    residual: dict[str, np.ndarray] = {}
    counted: dict[str, np.ndarray] = {}
    failed: dict[str, str] = {}
    for trial in reweighted(unseen, weights):
        try:
            if fit is None:
                raise SimulationError(why)
            fitter = Fitter(model, [trial])
            start = start_of(fitter, model, fit.hypothesis, fit.z, trial)
            raw, keep = fitter.residual(fit.hypothesis, fit.z, trial, start)
            by = {c: (weights.get(c) or 1.0) / (whole.weights.get(c) or 1.0) for c in trial.channels}
            scale = np.concatenate([np.full(part.size, by[c]) for c, part in split(raw, trial).items()])
            residual[trial.id], counted[trial.id] = np.where(keep, raw * scale, 0.0), keep
        except SimulationError as error:
            failed[trial.id] = str(error)
            residual[trial.id], counted[trial.id] = nothing_foretold(now[trial.id]), trial.valid
    return HeldOut(residual, counted, failed=failed, cuts={t.id: t.cuts for t in unseen})
