"""Which law to learn, and where: every kind at every port is fitted, and the most probable one must leave but noise.

A formula takes the curve's place only where it was fitted in the simulation itself, leaves but noise, and predicts
trials that it has not seen as well as the curve does; each fold finds its own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.starts import effect_starts
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.learning.curves import CELLS, Curve, Sketch, fit_curve, sketch
from spacerobot.diagnosis.learning.ended import ended
from spacerobot.diagnosis.learning.learnt import Learnt
from spacerobot.diagnosis.selection.held_out import MOST_FOLDS, folds
from spacerobot.diagnosis.selection.intervals import by_curvature
from spacerobot.diagnosis.selection.judge import Judgement, moved
from spacerobot.diagnosis.selection.kept_aside import Unseen
from spacerobot.diagnosis.selection.nameable import not_shown
from spacerobot.diagnosis.selection.rig_fold import Predictions, unseen_of
from spacerobot.diagnosis.selection.search_state import Found, Report, effect_values, run_tasks
from spacerobot.diagnosis.selection.unseen import foretell
from spacerobot.diagnosis.terms.decision import AS_GOOD, MARGIN
from spacerobot.diagnosis.terms.kinds import LEARNED, SAME
from spacerobot.effects.learned import Kind, Variable, ports_for

TRIED: tuple[tuple[str, Kind, Variable], ...] = (
    ("wrist", "force", "v"),
    ("wrist", "force", "d"),
    ("wrist", "friction", "d"),
    ("wrist", "friction", "N"),
    ("wrist", "memory", "z"),
    ("contact", "force", "d"),
    ("contact", "force", "v"),
    ("target", "force", "v"),
    ("target", "force", "d"),
    ("target", "friction", "d"),
)
"""Ports and kinds of law, the plainer first. Friction of a level g(v) is left out: a force f(v) shows the same."""


R = TypeVar("R")

STARTS = 2
"""From which an effect of the catalogue is fitted where a law acts."""

WITHIN = 1.05
"""Cost of a curve, over the best set's of the catalogue, up to which it may still cost less once fitted to its end:
that was worth a fortieth where a drag stopped its target.
"""


def as_learned(said: Judgement, learnt: Learnt) -> Judgement:
    """What is said where a law was learned."""
    confidence = float(np.clip(1.0 / (1.0 + np.exp(-min(learnt.lead, 700.0))), 0.05, 0.99))
    return replace(
        said, verdict=LEARNED, confidence=confidence, chosen=learnt.fit, alternatives=(), moved=moved(learnt.fit)
    )


def learn(pool: Pool, found: Found, report: Report) -> Learnt | None:
    """The law that explains what is left, alone or beside the effect that explains most; None where none does.

    Args:
        pool: runs the fits.
        found: what the search has found; what else of the catalogue was tried where a law acts is added.
        report: told of progress.
    """
    if not pool.workshop.model.learns:
        return None
    singles = [f for f in found.fits.values() if len(f.hypothesis.sites) == 1 and not found.implausible(f)]
    for beside in (found.baseline, *([found.preferred(singles)] if singles else [])):
        learnt = _learn(pool, beside, found, report)
        if learnt is not None and learnt.trusted:
            return learnt
    return None


def _catalogue_there(pool: Pool, curve: Curve, found: Found, report: Report) -> None:
    """Fits what the catalogue has where the law acts, each effect from starts of its own, into what was found.

    A line that is taut from the first bends every track; at a fit without it, it promises nothing at any size.
    """
    made, known = curve.fit.hypothesis, effect_values(curve.fit)
    beside = [s.label for s in made.sites if not s.effect.learned]
    tasks = [
        Task(tuple(sorted((*beside, site.label))), {**known, **start}, only=made.only)
        for site in found.singles
        if site.where == curve.site.where and site.label not in beside
        for start in effect_starts([site])[:STARTS]
    ]
    run_tasks(pool, found, tasks, report, "what the catalogue has where the law acts", stop=True)


def _named_as_well(curve: Curve, found: Found) -> bool:
    """Whether a set of the catalogue says as much for fewer numbers, or nearly; each must earn its BIC."""
    price = float(np.log(float(curve.fit.samples)))
    own = curve.fit.cost + price * (curve.determined() + len(curve.fit.hypothesis.sites) - 1)
    return any(f.cost + price * _numbers(f) < own + MARGIN for f in found.fits.values() if not found.implausible(f))


def _numbers(fit: Fit) -> int:
    return sum(f.kind == "effect" for f in fit.hypothesis.free)


def _learn(pool: Pool, beside: Fit, found: Found, report: Report) -> Learnt | None:
    """The law that explains what is left beside a fit.

    None where no curve at one port leaves nothing but noise, or where the catalogue says as much.
    """
    machine = pool.workshop.model.trial_mechanism(beside.hypothesis, beside.z, pool.workshop.trials[0])
    begun = [pool.aside(sketch, beside, *t) for t in TRIED if t[0] in ports_for(t[1], machine)]
    told = _answers(begun, report, "learning a law")
    curves, least = _curves(pool, beside, found, told, report)
    if not curves or curves[0].fit.cost > WITHIN * found.best.cost:
        return None
    report("learning it to the end", 0, 1)
    best, form = pool.aside(ended, curves[0], beside)()
    left = pool.workshop.left_by(best.fit)
    if not left.adequate or _hidden(best, left.inflation):
        return None
    _catalogue_there(pool, best, found, report)
    if _named_as_well(best, found):
        return None
    lead = min([best.evidence - c.evidence for c in curves[1:]] + [0.5 * (least - best.fit.cost)])
    held = _held(pool, best, beside, report)
    if form is None or held is None or not pool.workshop.left_by(form[1]).adequate:
        return Learnt(best, lead, held)
    if sum(held.selected.chi2.values()) > AS_GOOD**2 * sum(held.after.chi2.values()):
        return Learnt(best, lead, held)
    return Learnt(best, lead, replace(held, after=held.selected), *form)


def _curves(pool: Pool, beside: Fit, found: Found, told: Sequence[Sketch], report: Report) -> tuple[list[Curve], float]:
    """Curves at the noise as it is, the most probable first, and what any that is left out costs at least.

    The two that cost least under loud noise, then of the others those that could still cost less. No curve is thought
    to ask more of what is believed than a fit that lacks it does.
    """
    bent = max(beside.prior, found.best.prior) + CELLS
    ranked = sorted(told, key=lambda s: s.cost)
    done: list[Curve] = []
    least = float("inf")
    for some in (ranked[:2], ranked[2:]):
        bar = WITHIN * min([found.best.cost, *(c.fit.cost for c in done)])
        least = min([least, *(s.least(bent) for s in some if s.least(bent) >= bar)])
        begun = [pool.aside(fit_curve, beside, s) for s in some if s.least(bent) < bar]
        done += _answers(begun, report, "learning the likeliest laws")
    return sorted(done, key=lambda c: -c.evidence), least


def _answers(begun: Sequence[Callable[[], R | None]], report: Report, what: str) -> list[R]:
    """What is under way, as it comes; without what could not be simulated."""
    found = []
    for number, waiting in enumerate(begun):
        report(what, number, len(begun))
        if (one := waiting()) is not None:
            found.append(one)
    return found


def _hidden(curve: Curve, inflation: float) -> bool:
    """Whether an effect beside the curve is not shown: the law is meant without it, or something else is."""
    fit = curve.fit
    ends = by_curvature(fit, inflation)
    return any(not_shown(s, fit.values(), ends) for s in fit.hypothesis.sites if not s.effect.learned)


def _held(pool: Pool, curve: Curve, beside: Fit, report: Report) -> Unseen | None:
    """The curve learned anew without each condition, from the baseline of the other trials, and its predictions."""
    sets = [out for _, out in folds(pool.workshop.trials, MOST_FOLDS)]
    if len(sets) < 2:
        return None
    shape = curve.shape
    task = Task(beside.hypothesis.label, dict(beside.values()), only=beside.hypothesis.only)
    begun = [pool.aside(_fold, out, task, curve.site.where, shape.kind, shape.of) for out in sets]
    return unseen_of(pool.workshop, _answers(begun, report, "learning it again without a part of the trials"))


def _fold(workshop: Workshop, out: tuple[str, ...], beside: Task, where: str, kind: Kind, of: Variable) -> Predictions:
    rest = workshop.but_for(out)
    unseen = [t for t in workshop.trials if t.id in out]
    baseline = rest.run(Task((), {}))
    start = baseline if not beside.label else rest.run(beside)
    told = None if start is None else sketch(rest, start, where, kind, of)
    curve = None if told is None or start is None else fit_curve(rest, start, told)
    form = None
    if curve is not None and start is not None:
        curve, form = ended(rest, curve, start)
    before = foretell(workshop.model, baseline, unseen)
    after = foretell(workshop.model, None if curve is None else curve.fit, unseen)
    closely = after if form is None else foretell(workshop.model, form[1], unseen)
    return Predictions(out, before, after, closely, SAME)
