"""Trials kept aside: what the others lead to, how well that predicts them, and what may then be named."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from spacerobot.diagnosis.selection.check import Check
from spacerobot.diagnosis.selection.held_out import HeldOut
from spacerobot.diagnosis.terms.decision import TIE
from spacerobot.diagnosis.terms.hypothesis import Label
from spacerobot.diagnosis.terms.kinds import OPEN, OTHER, SAME, LeadsTo


@dataclass(frozen=True)
class Fold:
    """What was kept aside, and what the other trials say.

    Attributes:
        out: ids of the trials kept aside.
        selected: the set that the others lead to.
        leads_to: what that is to the set chosen on all trials, as far as this one's effects act in the others.
    """

    out: tuple[str, ...]
    selected: Label
    leads_to: LeadsTo


@dataclass(frozen=True, eq=False)
class Unseen:
    """How well trials are predicted by what was decided and fitted without them.

    Attributes:
        scheme: what is left out in turn, in words.
        folds: what each led to.
        before: errors of the baseline.
        after: of the set chosen on all trials.
        selected: of the set that each fold has chosen by itself.
        everywhere: whether any of the chosen set's effects acts in more than some trials.
        rivals: errors of the further sets that the folds chose among.
        taken: what was found from the unseen trials themselves, in words.
        or_values: whether wrong values may be meant in the place of the set: they foretell as much.
    """

    scheme: str
    folds: tuple[Fold, ...]
    before: HeldOut
    after: HeldOut
    selected: HeldOut
    everywhere: bool = True
    rivals: Mapping[Label, HeldOut] = field(default_factory=dict)
    taken: tuple[str, ...] = ()
    or_values: bool = False

    @property
    def told(self) -> tuple[HeldOut, HeldOut, HeldOut]:
        """In the order of `kinds.TOLD`."""
        return self.before, self.after, self.selected

    def leading_to(self, *what: LeadsTo) -> list[Fold]:
        """Folds that lead to such a set by themselves."""
        return [f for f in self.folds if f.leads_to in what]

    def check(self, name: str = "held out", *, whole: bool = True) -> Check:
        """Whether a set may be named, as far as unseen trials tell.

        Not where most folds lead to something else; nor where those that lead to it (all, where none does) predict
        their trials no better with it. What acts in one trial alone, no other trial can foretell.

        Args:
            name: of the check.
            whole: whether a good model leaves nothing but noise. Where none does, several sets say the same of much
                that is left: what other folds choose must predict their trials as well; and folds that lead to the
                set may have seen too little of it to foretell it: all of them together may.
        """
        same, other, count = len(self.leading_to(SAME)), self.leading_to(OTHER), len(self.folds)
        said = f"without a part of the trials {same} of {count} times the same set is chosen"
        if 2 * len(other) > count:
            said = f"without a part of the trials {len(other)} of {count} times another set is chosen"
            if whole or not self._better(other, self.selected):
                return Check(name, False, said)
            said += ", which predicts what was kept aside worse"
        telling = self.leading_to(SAME, OPEN) or self.folds
        as_well = self.or_values and self.after.together < (1.0 + TIE) * self.before.together
        better = as_well or self._better(telling) or (not whole and self._better(self.folds))
        if self.everywhere and not better:
            said += ", and it predicts trials that were kept aside no better than the baseline"
        return Check(name, better or not self.everywhere, said)

    def _better(self, folds: Sequence[Fold], than: HeldOut | None = None) -> bool:
        """Whether the chosen set predicts these folds' trials better, than the baseline if nothing else is said."""
        other, after = ((than or self.before).chi2, self.after.chi2)
        trials = [t for f in folds for t in f.out]
        return sum(after[t] for t in trials) < sum(other[t] for t in trials)
