"""A part's law learned again without some of its trials, which it then predicts; and its formula with it."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.learning.curves import Curve
from spacerobot.diagnosis.learning.part import Taken
from spacerobot.diagnosis.learning.part_form import written
from spacerobot.diagnosis.learning.weighed import Law, begun, settled, shape_for
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.held_out import MOST_FOLDS, HeldOut, folds, scheme_of
from spacerobot.diagnosis.selection.kept_aside import Fold, Unseen
from spacerobot.diagnosis.selection.part_fold import errors_of, joined
from spacerobot.diagnosis.selection.search_state import Report
from spacerobot.diagnosis.selection.unseen import NOT_FITTED
from spacerobot.diagnosis.terms.kinds import OTHER, SAME, TOLD, LeadsTo, Told
from spacerobot.support.errors import SimulationError


def kept_aside(taken: Taken, report: Report) -> tuple[Unseen, HeldOut]:
    """Every trial predicted by the law as the others tell it, and by the catalogue's best; `selected` by its formula.

    The kind of law, its port and what stands beside it are those that all trials led to.
    """
    trials = taken.bench.model.trials
    sets = [out for _, out in folds(trials, MOST_FOLDS)]
    kept, done, best = [], [], []
    for number, out in enumerate(sets):
        report("learning it again without a part of the trials", number, len(sets))
        errors, catalogue = _fold(taken, out)
        kept.append(Fold(tuple(out), taken.curve.fit.hypothesis.label, _leads_to(errors["after"], catalogue)))
        done.append(errors)
        best.append(catalogue)
    before, after, selected = (joined([by[name] for by in done]) for name in TOLD)
    own = ("each piece's own start, from its readings and the sensor's noise",)
    unseen = Unseen(scheme_of(trials, MOST_FOLDS), tuple(kept), before, after, selected, taken=own)
    return unseen, joined(best)


def _leads_to(law: HeldOut, catalogue: HeldOut) -> LeadsTo:
    return SAME if law.total < catalogue.total else OTHER


def _fold(taken: Taken, out: Sequence[str]) -> tuple[Mapping[Told, HeldOut], HeldOut]:
    whole, model = taken.bench, taken.bench.model
    unseen = [t for t in model.trials if t.id in out]
    nothing = {name: errors_of(whole, whole.weights, None, unseen, NOT_FITTED) for name in TOLD}
    try:
        rest = model.but_for(out)
        if not rest.trials:
            return nothing, nothing["before"]
        bench = Bench(rest, whole.threads, whole.kept.within(f"without {', '.join(out)}"))
        bench.weights = whole.weights
        baseline = bench.baseline()
        catalogue = _again(bench, baseline, taken.best.fit)
        beside = _again(bench, baseline, taken.curve.fit) or baseline
        bench.weigh(beside)  # a curve is begun at the noise that a fit without it asks for
        curve = _learned(bench, taken.law, beside)
        fit = None if curve is None else curve.fit
        form = None if curve is None else written(bench, curve)
    except SimulationError:
        return nothing, nothing["before"]
    told = {"before": baseline, "after": fit, "selected": fit if form is None else form[1]}
    fits: list[tuple[Told, Fit | None]] = [(name, told[name]) for name in TOLD]
    errors = {name: errors_of(whole, whole.weights, one, unseen, NOT_FITTED) for name, one in fits}
    return errors, errors_of(whole, whole.weights, catalogue, unseen, NOT_FITTED)


def _again(bench: Bench, baseline: Fit, fit: Fit) -> Fit | None:
    """The effects of a fit without its curve, fitted to a bench's trials."""
    sites = [s for s in fit.hypothesis.sites if not s.effect.learned]
    if not sites:
        return baseline
    start = {k: v for k, v in fit.values().items() if any(k.startswith(f"{s.effect.name}@{s.where}.") for s in sites)}
    return bench.fitted_as(baseline, sites, start)


def _learned(bench: Bench, law: Law, beside: Fit) -> Curve | None:
    with contextlib.suppress(SimulationError):
        shape = shape_for(bench, beside, law)
        if shape is not None:
            return settled(bench, beside.hypothesis.sites, begun(shape, law.where, beside))
    return None
