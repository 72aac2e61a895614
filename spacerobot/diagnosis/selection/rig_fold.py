"""Trials of a wrist rig kept aside: everything is decided again without them, what was decided predicts them.

Nothing here knows the trials that are left out before they are predicted: the rig as believed is fitted to the others,
the sets in play are fitted from starts that these lead to, and the same judge decides. What is not shown is taken
back, by the curvature of the fold's fits.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.selection.decide import conclude
from spacerobot.diagnosis.selection.held_out import MOST_FOLDS, HeldOut, folds, scheme_of
from spacerobot.diagnosis.selection.intervals import curved
from spacerobot.diagnosis.selection.judge import Judgement
from spacerobot.diagnosis.selection.kept_aside import Fold, Unseen
from spacerobot.diagnosis.selection.refit import refit
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.selection.unseen import Foretold, foretell, nothing_foretold, seen_sites
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Label, Site, label_of
from spacerobot.diagnosis.terms.kinds import AMBIGUOUS, NAMED, OPEN, OTHER, PART, SAME, TOLD, LeadsTo
from spacerobot.support.errors import SimulationError

RIVALS = 3
"""Sets nearest to the chosen one that each fold chooses among, beside those that are not told apart."""


@dataclass(frozen=True)
class Predictions:
    """What was left out, and what was said of it without having seen it.

    Attributes:
        out: trials left out.
        before: of the baseline.
        after: of the set that was chosen on all trials, fitted to the others.
        selected: of the set that the others alone lead to.
        leads_to: what that set is to the chosen one, as far as this one's effects act in the others.
        rivals: of the further sets that it chose among, in their order.
    """

    out: tuple[str, ...]
    before: Foretold
    after: Foretold
    selected: Foretold
    leads_to: LeadsTo
    rivals: tuple[Foretold, ...] = ()


def folded(
    workshop: Workshop,
    out: tuple[str, ...],
    chosen: Sequence[Site],
    rivals: Sequence[Sequence[Site]],
    thorough: bool,
    known: Collection[tuple[str, str]] | None = None,
) -> Predictions:
    """A fold's predictions.

    Args:
        workshop: of all trials.
        out: trials to leave out.
        chosen: the set that was chosen on all trials.
        rivals: further sets that the fold chooses among.
        thorough: whether they are fitted from more starts where the first ones explain little.
        known: (effect, where) of the catalogue that was searched; None for all.
    """
    unseen = [t for t in workshop.trials if t.id in out]
    sites = seen_sites(chosen, out)
    label = label_of(sites)
    try:
        with Pool(workshop.but_for(out), 1) as pool:
            found = refit(pool, sites, [seen_sites(r, out) for r in rivals], thorough, known)
            decided = curved(pool.workshop, conclude(pool, found, lambda what, done, total: None))
    except SimulationError as error:
        none = Foretold((), failed={t.id: str(error) for t in unseen})
        return Predictions(out, none, none, none, OTHER, (none,) * len(rivals))
    said = decided.judgement
    best = said.chosen.hypothesis.label
    after = said.chosen if best == label else _fit_of(found, sites)
    others = [_fit_of(found, seen_sites(r, out)) for r in rivals]
    asked = {id(f): f for f in (found.baseline, after, said.chosen, *others)}
    sets = {label_of(seen_sites(one, out)): one for one in (*rivals, chosen)}
    told = {key: foretell(workshop.model, _going_on(fit, sets), unseen) for key, fit in asked.items()}
    leads_to: LeadsTo
    if best == label:
        leads_to = SAME
    elif any(f.hypothesis.label == label for f in said.alternatives):
        leads_to = OPEN
    else:
        leads_to = PART if contains(label, best) else OTHER
    rest = tuple(told[id(f)] for f in others)
    return Predictions(out, told[id(found.baseline)], told[id(after)], told[id(said.chosen)], leads_to, rest)


def _going_on(fit: Fit | None, sets: Mapping[Label, Sequence[Site]]) -> Fit | None:
    """A fit to others, with its effects in the unseen trials too that a set has them in: what began one day goes on."""
    if fit is None:
        return None
    meant = {s.label: s for s in sets.get(fit.hypothesis.label, ())}
    sites = tuple(meant.get(s.label, s) if s.trials else s for s in fit.hypothesis.sites)
    return replace(fit, hypothesis=replace(fit.hypothesis, sites=sites))


def _fit_of(found: Found, sites: Sequence[Site]) -> Fit | None:
    label = label_of(sites)
    return found.fits.get(label) if label else found.baseline


def hold_out(
    pool: Pool, judgement: Judgement, known: Collection[tuple[str, str]] | None = None
) -> Callable[[], Unseen | None]:
    """Begin to decide again without each fold, and to predict it; asked for, the result. None where nothing is left.

    Args:
        pool: runs the folds, side by side.
        judgement: what was decided on all trials.
        known: (effect, where) of the catalogue that was searched; None for all.
    """
    sets = [out for _, out in folds(pool.workshop.trials, MOST_FOLDS)]
    if len(sets) < 2:
        return lambda: None
    chosen = judgement.chosen.hypothesis
    rivals = [fit.hypothesis.sites for fit in _in_play(judgement) if fit.hypothesis.label != chosen.label]
    thorough = judgement.verdict in (NAMED, AMBIGUOUS)
    about = [chosen.label, chosen.only, [[s.label for s in r] for r in rivals], thorough]
    begun = [
        pool.kept_aside(Predictions, ["fold", out, *about], folded, out, chosen.sites, rivals, thorough, known)
        for out in sets
    ]

    everywhere = any(not s.trials for s in chosen.sites)
    return lambda: unseen_of(pool.workshop, [one() for one in begun], [label_of(r) for r in rivals], everywhere)


def unseen_of(
    workshop: Workshop, done: Sequence[Predictions], rivals: Sequence[Label] = (), everywhere: bool = True
) -> Unseen:
    """The folds' predictions put together.

    Args:
        workshop: of all trials.
        done: what each fold said.
        rivals: that each chose among, in their order.
        everywhere: whether any of the chosen set's effects acts in more than some trials.
    """
    trials, model = workshop.trials, workshop.model
    before, after, selected = (_errors(model, trials, done, attrgetter(name)) for name in TOLD)
    return Unseen(
        scheme_of(trials, MOST_FOLDS),
        tuple(Fold(d.out, d.selected.label, d.leads_to) for d in done),
        before,
        after,
        selected,
        everywhere=everywhere,
        rivals={label: _errors(model, trials, done, _rival(k)) for k, label in enumerate(rivals)},
        taken=tuple(taken([d.after for d in done])),
    )


def _rival(number: int) -> Callable[[Predictions], Foretold]:
    return lambda fold: fold.rivals[number]


def _in_play(judgement: Judgement) -> list[Fit]:
    """What was not told apart from the chosen set, and what comes nearest to it; those with an effect.

    One that holds another of these as a special case tells nothing more.
    """
    near: list[Fit] = []
    for rival in sorted(judgement.rivals, key=lambda r: r.score):
        label = rival.fit.hypothesis.label
        if label and len(near) < RIVALS and not any(contains(label, n.hypothesis.label) for n in near):
            near.append(rival.fit)
    return [*(f for f in judgement.alternatives if f.hypothesis.sites and f not in near), *near]


def _errors(
    model: RigModel, trials: Sequence[TrialData], done: Sequence[Predictions], of: Callable[[Predictions], Foretold]
) -> HeldOut:
    residuals: dict[str, np.ndarray] = {}
    failed: dict[str, str] = {}
    told = {trial: of(fold) for fold in done for trial in fold.out}
    for trial in trials:
        row = told[trial.id].residual(model, trial)
        if row is None:
            failed[trial.id] = told[trial.id].failed[trial.id]
            row = nothing_foretold(trial)
        residuals[trial.id] = row
    paid = {t.id: told[t.id].paid.get(t.id, 0.0) for t in trials}
    return HeldOut(residuals, {t.id: t.valid for t in trials}, paid, failed, {t.id: t.cuts for t in trials})


def taken(said: Sequence[Foretold]) -> list[str]:
    """What was found from the unseen trials themselves, in words."""
    found = ["each trial's own start, from its readings"]
    own = sorted({k.split("|", 1)[1] for f in said for v in f.own.values() for k in v if "|" in k})
    if own:
        alone = any(x > 0.0 for f in said for x in f.paid.values())
        where = "from its other trials, where it has none from the trial itself under its prior, whose cost counts"
        found.append(f"each condition's own {', '.join(own)}, {where if alone else 'from its other trials'}")
    within = sorted(t for f in said for t, v in f.own.items() if any("|" not in k for k in v))
    if within:
        which = f"trial{'s' if len(within) > 1 else ''} {', '.join(within)}"
        found.append(f"of {which}, values within what the other trials leave open, from the trial itself at that cost")
    return found
