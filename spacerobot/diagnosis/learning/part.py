"""A law learned at a part: a joint, an axis, a body. What decides is what trials kept aside say, as everywhere there.

Every kind of law at every port of the part is fitted as a curve, beside the effects that the catalogue had to offer.
The one that predicts best is taken. Effects that it makes idle go, one that shows only beside it comes. It must predict
unseen trials clearly better than the catalogue's best, and where the noise is stated leave no more than that.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.noise import counted_by_channel
from spacerobot.diagnosis.learning.beside import beside_it, better_of, form_of, tested, without_curve
from spacerobot.diagnosis.learning.curves import Curve, fitted, from_where_it_is
from spacerobot.diagnosis.learning.describe import Described
from spacerobot.diagnosis.learning.roughness import likeliest
from spacerobot.diagnosis.learning.weighed import Law, begun, misfit, settled, shape_for
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.conclusion import unshown
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.model_choice import pays, ratio, surely
from spacerobot.diagnosis.selection.part_result import NotLearned
from spacerobot.diagnosis.selection.search_state import Report
from spacerobot.diagnosis.terms.decision import LOUD, REPEATS, TIE, WORTH_OF_REST
from spacerobot.effects.plane import across
from spacerobot.support.errors import SimulationError

TRIED = 3
"""Kinds of law, those that fit best, that are tried on unseen trials."""

LEVEL = "a level of friction"
"""The curve of effects where dry friction may act."""


def taken_by_curves(growth: Growth) -> float:
    """Largest share of what is left, rms, that a curve at a port would take, as far as it acts linearly."""
    bench, fit = _bench(growth), growth.after.fit
    kept = counted_by_channel({t.id: fit.trials[t.id].residual for t in bench.trials}, bench.trials)
    whole = {c: float(np.sqrt(np.mean(np.square(np.concatenate(some))))) for c, some in kept.items()}
    most = 0.0
    for law in (one for one in laws_of(growth) if one.of != "q"):
        with contextlib.suppress(SimulationError):
            shape = shape_for(bench, fit, law)
            if shape is None:
                continue
            start, fitter = begun(shape, law.where, fit), bench.fitter()
            now = fitted(fitter, bench, growth.after.sites, start, 1)
            level = likeliest(bench.trials, now, fitter.rows_at(now.fit)).level
            most = max(most, 1.0 - max(level[c] / whole[c] for c in level if whole[c] > 0.0))
    return most


@dataclass(frozen=True, eq=False)
class Taken:
    """The law that predicts best.

    Attributes:
        bench: of the part, under the weights that the curve asks for.
        law: its kind and port.
        curve: as fitted.
        before, best, after: the baseline, the catalogue's best and the curve's model, as unseen trials have them.
        form: the curve's formula, and the model with it as unseen trials have it; None where none can be fitted.
        lead: log of its odds over the next other kind or port.
        next: held-out rms of the next other kind or port over its own [1].
    """

    bench: Bench
    law: Law
    curve: Curve
    before: Candidate
    best: Candidate
    after: Candidate
    form: tuple[Described, Candidate] | None
    lead: float
    next: float

    @property
    def better(self) -> Candidate:
        """Of curve and formula, what predicts better: beyond what a fold has visited a curve says nothing."""
        return self.after if self.form is None or self.form[1].error > self.after.error else self.form[1]


def laws_of(growth: Growth) -> Iterator[Law]:
    """Every kind of law at every port of a part where something is known to move, the plainer first."""
    model = growth.bench.model
    plain, fit = model.plain(), growth.after.fit
    trial = growth.bench.trials[0]
    rubbed = {s.where for s in growth.sites if s.effect.curve == LEVEL}
    beside = {other for p in plain.ports for other in across(plain, p)}
    for port in plain.ports:
        mechanism = model.trial_mechanism(fit.hypothesis, fit.z, trial)
        if not model.travelled(port, mechanism, trial, fit.trials[trial.id].initial):
            continue
        turns = plain.angular(port)
        if port not in beside:  # against the velocity, whatever its direction
            yield Law(port, "force", "v", turns)
        yield Law(port, "force", "d", turns)
        if port in rubbed and not across(plain, port):
            yield Law(port, "friction", "d", turns)
        if port.startswith("joint."):
            yield Law(port, "force", "q", turns)


def take(growth: Growth, report: Report) -> Taken | NotLearned:
    """The law that predicts a part's unseen trials best, or why there is none.

    Args:
        growth: of the part, to what the catalogue comes down.
        report: told of progress.
    """
    laws = list(laws_of(growth))
    if not laws:
        return NotLearned("nothing of it moves along a port at which a law could be learned")
    if len(growth.bench.left_out) < 2:
        return NotLearned("there are too few trials to keep one aside")
    found = []
    for done, law in enumerate(laws):
        report(f"learning a law at {law.where}", done, len(laws))
        bench = _bench(growth)
        curve = None
        with contextlib.suppress(SimulationError):
            shape = shape_for(bench, growth.after.fit, law)
            if shape is not None:
                curve = settled(bench, growth.after.sites, begun(shape, law.where, growth.after.fit))
        if curve is not None:
            found.append((misfit(bench, curve.fit), bench, law, curve))
    if not found:
        return NotLearned("no curve could be fitted")
    found.sort(key=lambda one: one[0])
    readings = max(growth.after.fit.samples, 1)
    gone = 1.0 - float(np.exp(0.5 * (found[0][0] - misfit(growth.bench, growth.after.fit)) / readings))
    if gone < TIE:
        said = f"no curve at a port of it takes more than {100.0 * max(gone, 0.0):.2g} % of what is left"
        return NotLearned(said, refuted=True)
    bench = found[0][1]  # the weights of the one that fits best, for all
    tried = []
    for place, (_, _, law, curve) in enumerate(found[:TRIED]):
        report(f"predicting unseen trials by a law at {law.where}", place, TRIED)
        again = settled(bench, without_curve(curve), from_where_it_is(curve), listen=False)
        if again is not None:
            tried.append((law, again, better_of(bench, again)))
    if not tried:
        return NotLearned("no curve could be fitted")
    least = min(tried, key=lambda one: one[2].error)
    near = [o for o in tried if ratio(o[2], least[2]) <= 1.0 + TIE or not surely(least[2], o[2], bench.trials)]
    law, curve, after = min(near, key=lambda one: one[1].determined())
    others = [one for one in tried if one[0] is not law]
    lead = min((curve.evidence - one[1].evidence for one in others), default=float("inf"))
    following = min((ratio(one[2], after) for one in others), default=float("inf"))
    before, best = (tested(bench, c.fit) for c in (growth.before, growth.after))
    if ratio(best, after) < 1.0 - WORTH_OF_REST:  # nothing that could stand beside it mends a law that misleads
        return NotLearned(leaves(law, ratio(after, best)), refuted=True)
    report("learning what stands beside it", 0, 1)
    curve = beside_it(growth, bench, curve, after)
    after = bench.tested(curve.fit)
    return Taken(bench, law, curve, before, best, after, form_of(bench, curve), lead, following)


def refused(taken: Taken) -> NotLearned | None:
    """Why a law is not believed; None where it is."""
    trials, share = taken.bench.trials, ratio(taken.better, taken.best)
    beats = share < 1.0 - WORTH_OF_REST and len({t.recorded for t in trials}) > REPEATS
    if not pays(taken.better, taken.best, trials):
        return NotLearned(leaves(taken.law, share), not surely(taken.better, taken.best, trials), beats)
    if loud := louder(taken.bench, taken.curve.fit):
        return NotLearned(f"{_best(taken.law)} still leaves {loud:.3g} times the stated noise", beats=beats)
    if why := unshownbeside(taken.curve.fit):
        return NotLearned(f"{_best(taken.law)} is told from no effect beside it: {why}")
    return None


def leaves(law: Law, share: float) -> str:
    """What a law that predicts no better leaves, as a share of what the catalogue's best does."""
    found = f"{100.0 * share:.3g} % of the error of the catalogue's best on trials kept aside"
    return f"{_best(law)} leaves {found}" + (", not throughout" if share < 1.0 else "")


def _best(law: Law) -> str:
    return f"the law that predicts best ({words(law)})"


def words(law: Law) -> str:
    """A kind of law in words."""
    of = {"v": "rate", "d": "displacement", "q": "displacement within a period"}[law.of]
    return f"{'dry friction' if law.kind == 'friction' else 'a force'} of its {of} at {law.where}"


def louder(bench: Bench, fit: Fit) -> float:
    """What a fit leaves over the stated noise of the loudest channel; nothing where none is stated or it is no more."""
    most = max(bench.loudness(fit).values(), default=0.0)
    return most if most > LOUD else 0.0


def unshownbeside(fit: Fit) -> str:
    """Why an effect beside a curve is not shown; empty where all are."""
    sites = tuple(s for s in fit.hypothesis.sites if not s.effect.learned)
    return unshown(replace(fit, hypothesis=replace(fit.hypothesis, sites=sites)))


def _bench(growth: Growth, model: Machine | None = None) -> Bench:
    """A bench of a part under the weights that its chosen model asks for."""
    own = growth.bench
    bench = Bench(own.model if model is None else model, own.threads, own.kept.within("learning"))
    bench.weights = own.weights
    return bench
