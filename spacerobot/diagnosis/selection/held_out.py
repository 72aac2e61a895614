"""Held-out conditions: everything decided without them, what was decided predicts them; before against after."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from operator import attrgetter

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.selection.check import Check
from spacerobot.diagnosis.selection.fold import Fold, folded
from spacerobot.diagnosis.selection.judge import Judgement
from spacerobot.diagnosis.selection.unseen import Foretold, nothing_foretold
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Label, label_of
from spacerobot.diagnosis.terms.kinds import AMBIGUOUS, NAMED, OPEN, OTHER, SAME, TOLD

MOST_FOLDS = 6
"""Conditions, or trials, that are left out one by one; of more, so many groups are left out in turn."""

RIVALS = 3
"""Sets nearest to the chosen one that each fold chooses among, beside those that are not told apart."""


@dataclass(frozen=True, eq=False)
class Errors:
    """Prediction errors of one model of every fold.

    Attributes:
        residuals: weighted residual by trial, shape (S,).
        chi2: by trial, sum of their squares and what its condition's own values cost.
        failed: trial -> why it could not be predicted; its residual is then that of predicting each channel's mean.
    """

    residuals: Mapping[str, np.ndarray]
    chi2: Mapping[str, float]
    failed: Mapping[str, str]

    @property
    def total(self) -> float:
        """chi-squared over all held-out trials."""
        return float(sum(self.chi2.values()))


@dataclass(frozen=True, eq=False)
class HeldOut:
    """How well trials are predicted by what was decided and fitted without them.

    Attributes:
        scheme: what is left out in turn, in words.
        folds: what was decided and said in each.
        before: errors of the baseline.
        after: of the set chosen on all trials.
        selected: of the set that each fold has chosen by itself.
        everywhere: whether any of the chosen set's effects acts in more than some trials.
        rivals: errors of the further sets that the folds chose among.
    """

    scheme: str
    folds: tuple[Fold, ...]
    before: Errors
    after: Errors
    selected: Errors
    everywhere: bool = True
    rivals: Mapping[Label, Errors] = field(default_factory=dict)

    def leading_to(self, *what: str) -> list[Fold]:
        """Folds that lead to such a set by themselves."""
        return [f for f in self.folds if f.leads_to in what]

    def check(self) -> Check:
        """Whether a set may be named, as far as unseen trials tell.

        Not where most folds lead to something else; nor where those that lead to it (all, where none does) predict
        their trials no better with it. What acts in one trial alone, no other trial can foretell.
        """
        same, count = len(self.leading_to(SAME)), len(self.folds)
        said = f"without a part of the trials {same} of {count} times the same set is chosen"
        if 2 * len(self.leading_to(OTHER)) > count:
            others = f"{len(self.leading_to(OTHER))} of {count} times another set is chosen"
            return Check("held out", False, f"without a part of the trials {others}")
        telling = [t for f in self.leading_to(SAME, OPEN) or self.folds for t in f.out]
        before, after = (sum(e.chi2[t] for t in telling) for e in (self.before, self.after))
        if self.everywhere and not after < before:
            worse = "it predicts trials that were kept aside no better than the baseline"
            return Check("held out", False, f"{said}, and {worse}")
        return Check("held out", True, said)


def folds(trials: Sequence[TrialData]) -> tuple[str, list[tuple[str, ...]]]:
    """Sets of trials to leave out in turn: conditions, or trials where there is one condition only."""
    groups: dict[str, list[str]] = {}
    for trial in trials:
        groups.setdefault(trial.condition, []).append(trial.id)
    what = "condition" if len(groups) > 1 else "trial"
    sets = [*groups.values()] if len(groups) > 1 else [[t.id] for t in trials]
    scheme = f"leave one {what} out" if len(sets) <= MOST_FOLDS else f"leave every {MOST_FOLDS}th {what} out"
    parts = [[id for ids in sets[k::MOST_FOLDS] for id in ids] for k in range(min(MOST_FOLDS, len(sets)))]
    return scheme, [tuple(part) for part in parts]


def hold_out(pool: Pool, judgement: Judgement) -> Callable[[], HeldOut | None]:
    """Begin to decide again without each fold, and to predict it; asked for, the result. None where nothing is left.

    Args:
        pool: runs the folds, side by side.
        judgement: what was decided on all trials.
    """
    scheme, sets = folds(pool.workshop.trials)
    if len(sets) < 2:
        return lambda: None
    chosen = judgement.chosen.hypothesis
    rivals = [fit.hypothesis.sites for fit in _in_play(judgement) if fit.hypothesis.label != chosen.label]
    thorough = judgement.verdict in (NAMED, AMBIGUOUS)
    about = [chosen.label, chosen.only, [[s.label for s in r] for r in rivals], thorough]
    begun = [pool.kept_aside(["fold", out, *about], folded, out, chosen.sites, rivals, thorough) for out in sets]

    def result() -> HeldOut:
        done = tuple(Fold.from_json(one()) for one in begun)
        trials, model = pool.workshop.trials, pool.workshop.model
        before, after, selected = (errors_of(model, trials, done, attrgetter(name)) for name in TOLD)
        others = {label_of(sites): errors_of(model, trials, done, _rival(k)) for k, sites in enumerate(rivals)}
        return HeldOut(scheme, done, before, after, selected, any(not s.trials for s in chosen.sites), others)

    return result


def _rival(number: int) -> Callable[[Fold], Foretold]:
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


def errors_of(
    model: RigModel, trials: Sequence[TrialData], done: Sequence[Fold], of: Callable[[Fold], Foretold]
) -> Errors:
    """Errors of one model of every fold, over the trials that each has left out."""
    residuals: dict[str, np.ndarray] = {}
    chi2: dict[str, float] = {}
    failed: dict[str, str] = {}
    told = {trial: of(fold) for fold in done for trial in fold.out}
    for trial in trials:
        said = told[trial.id]
        row = said.residual(model, trial)
        if row is None:
            failed[trial.id] = said.failed[trial.id]
            row = nothing_foretold(trial)
        residuals[trial.id] = row
        chi2[trial.id] = float(row @ row) + said.paid.get(trial.id, 0.0)
    return Errors(residuals, chi2, failed)
