"""Which law to learn, and where: every kind at every port is fitted, and the most probable one must leave but noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.learning.curves import Curve, fit_curve
from spacerobot.diagnosis.selection.held_out import MOST_FOLDS, folds
from spacerobot.diagnosis.selection.judge import Judgement, moved
from spacerobot.diagnosis.selection.kept_aside import Unseen
from spacerobot.diagnosis.selection.rig_fold import Predictions, unseen_of
from spacerobot.diagnosis.selection.search_state import Report
from spacerobot.diagnosis.selection.unseen import foretell
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Hypothesis
from spacerobot.diagnosis.terms.kinds import LEARNED, SAME
from spacerobot.effects.learned import Kind, Variable

TRIED: tuple[tuple[str, Kind, Variable], ...] = (
    ("wrist", "force", "v"),
    ("wrist", "force", "d"),
    ("wrist", "friction", "d"),
    ("wrist", "memory", "z"),
    ("target", "force", "v"),
    ("target", "force", "d"),
)
"""Ports and kinds of law, the plainer first. Friction of a level g(v) is left out: a force f(v) shows the same."""


@dataclass(frozen=True, eq=False)
class Learnt:
    """A law that was learned.

    Attributes:
        curve: the most probable one.
        lead: log of its odds over the next other kind or port.
        held: how well trials are predicted by it that it was not fitted to.
    """

    curve: Curve
    lead: float
    held: Unseen | None

    @property
    def trusted(self) -> bool:
        """Whether it predicts trials that it has not seen better than the baseline does."""
        return self.held is not None and self.held.check().passed


def as_learned(said: Judgement, learnt: Learnt) -> Judgement:
    """What is said where a law was learned."""
    confidence = float(np.clip(1.0 / (1.0 + np.exp(-min(learnt.lead, 700.0))), 0.05, 0.99))
    chosen = learnt.curve.fit
    return replace(said, verdict=LEARNED, confidence=confidence, chosen=chosen, alternatives=(), moved=moved(chosen))


def learn(pool: Pool, beside: Fit, report: Report) -> Learnt | None:
    """The law that explains what is left beside a fit; None where no curve at one port leaves nothing but noise.

    Args:
        pool: runs the fits.
        beside: of the baseline, or of named effects that stay.
        report: told of progress.
    """
    tried = [t for t in TRIED if t[0] in pool.workshop.model.trial_mechanism(*_first(pool, beside)).ports]
    begun = [pool.aside(fit_curve, beside, *one) for one in tried]
    curves: list[Curve] = []
    for done, waiting in enumerate(begun):
        report("learning a law", done, len(begun))
        curve = waiting()
        if curve is not None:
            curves.append(curve)
    curves.sort(key=lambda c: -c.evidence)
    if not curves:
        return None
    best = curves[0]
    if not pool.workshop.left_by(best.fit).adequate:
        return None
    lead = best.evidence - curves[1].evidence if len(curves) > 1 else float("inf")
    return Learnt(best, lead, _held(pool, best, beside, report))


def _first(pool: Pool, beside: Fit) -> tuple[Hypothesis, np.ndarray, TrialData]:
    return beside.hypothesis, beside.z, pool.workshop.trials[0]


def _held(pool: Pool, curve: Curve, beside: Fit, report: Report) -> Unseen | None:
    """The curve learned anew without each condition, from the baseline of the other trials, and its predictions."""
    sets = [out for _, out in folds(pool.workshop.trials, MOST_FOLDS)]
    if len(sets) < 2:
        return None
    shape = curve.shape
    task = Task(beside.hypothesis.label, dict(beside.values()), only=beside.hypothesis.only)
    begun = [pool.aside(_fold, out, task, curve.site.where, shape.kind, shape.of) for out in sets]
    done = []
    for number, waiting in enumerate(begun):
        report("learning it again without a part of the trials", number, len(begun))
        done.append(waiting())
    return unseen_of(pool.workshop, done)


def _fold(workshop: Workshop, out: tuple[str, ...], beside: Task, where: str, kind: Kind, of: Variable) -> Predictions:
    rest = workshop.but_for(out)
    unseen = [t for t in workshop.trials if t.id in out]
    baseline = rest.run(Task((), {}))
    start = baseline if not beside.label else rest.run(beside)
    curve = None if start is None else fit_curve(rest, start, where, kind, of)
    before = foretell(workshop.model, baseline, unseen)
    after = foretell(workshop.model, None if curve is None else curve.fit, unseen)
    return Predictions(out, before, after, after, SAME)
