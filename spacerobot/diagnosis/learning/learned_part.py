"""The last word on a part: what was said of it, or a law that was learned instead."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from spacerobot.diagnosis.learning.learnt import Learnt
from spacerobot.diagnosis.learning.part import Taken, louder, refused, take, taken_by_curves, words
from spacerobot.diagnosis.learning.part_held import kept_aside
from spacerobot.diagnosis.selection.candidate import Candidate, tried
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.kept_aside import Unseen
from spacerobot.diagnosis.selection.model_choice import agreeing, pays
from spacerobot.diagnosis.selection.part_result import NotLearned, Part
from spacerobot.diagnosis.selection.search_state import Report
from spacerobot.diagnosis.terms.decision import AS_GOOD, CROWD, DOUBT, MOST_LEFT, SMALL, TIE
from spacerobot.diagnosis.terms.kinds import AMBIGUOUS, LEARNED, NAMED, NOTHING_MISSING, UNKNOWN, WRONG_PARAMETER, Kind


@dataclass(frozen=True, eq=False)
class LearnedPart(Part):
    """A part at which a law was learned; its growth's choice is the model with the law.

    Attributes:
        learnt: the law.
        best: the catalogue's best beside it.
        next: held-out rms of the next other kind or port over its own [1].
    """

    learnt: Learnt | None = None
    best: Candidate | None = None
    next: float = np.inf

    @property
    def verdict(self) -> Kind:
        """As in verdict.json."""
        return LEARNED

    @property
    def confidence(self) -> float:
        """Between 0 and 1: how clear the lead over other kinds and ports is, and in how many unseen pieces it holds."""
        assert self.best is not None
        clear = 1.0 - DOUBT * float(np.exp(-max(self.next - 1.0, 0.0) / TIE))
        return float(np.clip(clear * agreeing(self.chosen, self.best), 0.05, 0.99))


def room_for_a_law(part: Part) -> bool:
    """Whether what is said of a part may be one law that has no name.

    Nothing of the catalogue explains it; or, where the noise is stated, what is named of it leaves more, or is a crowd
    at ports, where laws act.
    Where nothing is said to be missing and no noise is stated, a law that predicts better is what tells; and where
    something is named, one that takes most of what that leaves, if that is more than the named law's own small defect.
    """
    said, bench = part.verdict, part.growth.bench
    stated = bool(bench.model.stated_noise(part.fit.values()))
    if said in (NOTHING_MISSING, WRONG_PARAMETER):
        return not stated and part.shown
    if said not in (NAMED, AMBIGUOUS):
        return said == UNKNOWN
    if not stated:  # what is ambiguous says already that it is open
        named = said == NAMED and bool(part.fit.hypothesis.sites)
        return named and part.shown and not _own_defect(part) and taken_by_curves(part.growth) > MOST_LEFT
    ports = bench.model.plain().ports
    count = sum(s.effect.kind != "sensor" and s.where in ports for s in part.fit.hypothesis.sites)
    return louder(bench, part.fit) > 0.0 or count >= CROWD - (said == AMBIGUOUS)


def _own_defect(part: Part) -> bool:
    """Whether what a name leaves of unseen trials is so small a share of all it explains that its law may be to blame.

    Dry friction that turns round within a milliradian a second is dry friction.
    """
    before, after = part.before.mean_square, part.after.mean_square
    return after < SMALL * (before - after)


def settle_part(part: Part, report: Report) -> Part:
    """A law where the catalogue has none; the part as it is, with the reason, where none can be learned.

    Args:
        part: after its own checks.
        report: told of progress.
    """
    if not room_for_a_law(part):
        return part
    growth = part.uncut or part.growth
    taken = take(growth, report)
    if isinstance(taken, NotLearned):
        return replace(part, not_learned=taken)
    if (refusal := refused(taken)) is not None:
        return replace(part, not_learned=refusal)
    unseen, best = kept_aside(taken, report)
    foretold = min(unseen.after, unseen.selected, key=lambda held: held.total)
    if not pays(Candidate(taken.curve.fit, foretold), Candidate(taken.best.fit, best), taken.bench.trials):
        why = f"{words(taken.law)}, learned again without a part of the trials, predicts these no better"
        return replace(part, not_learned=NotLearned(why))
    return _learned(part, taken, unseen, growth)


def _learned(part: Part, taken: Taken, unseen: Unseen, growth: Growth) -> LearnedPart:
    """The part with the law; in a formula where that says as much as the curve."""
    chosen, learnt = taken.after, Learnt(taken.curve, taken.lead, unseen)
    if taken.form is not None and unseen.selected.total <= AS_GOOD**2 * unseen.after.total:
        told, one = taken.form
        if one.error <= AS_GOOD * taken.after.error and not louder(taken.bench, one.fit):
            said = replace(unseen, after=unseen.selected)
            chosen, learnt = one, Learnt(taken.curve, taken.lead, said, told, one.fit)
    considered = (_as_considered(growth, taken, chosen), *growth.considered)
    growth = replace(growth, bench=taken.bench, before=taken.before, after=chosen, rivals=(), considered=considered)
    return LearnedPart(growth, part.located, (), learnt.held, learnt=learnt, best=taken.best, next=taken.next)


def _as_considered(growth: Growth, taken: Taken, chosen: Candidate) -> Candidate:
    """The model with the law, its errors on the scale of those that the search has tried: by the catalogue's best."""
    known = next((c for c in growth.considered if c.label == growth.after.label), growth.considered_baseline)
    held = tried(chosen)
    by = known.error / taken.best.error if np.isfinite(known.error) and taken.best.error else 1.0
    return Candidate(chosen.fit, replace(held, residual={k: by * r for k, r in held.residual.items()}))
