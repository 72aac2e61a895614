"""From recordings to a judgement: the search, beliefs set free, what the best leave over, the decision.

Made once for the whole study, and once more for each part of it that is kept aside.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from spacerobot.diagnosis.fitting.adequacy import Left
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.selection.judge import Judgement, judge
from spacerobot.diagnosis.selection.rebase import rebased
from spacerobot.diagnosis.selection.search_state import Found, Report
from spacerobot.diagnosis.selection.without_prior import baseline_freed, set_free
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.decision import SLIGHT, SMALL
from spacerobot.diagnosis.terms.hypothesis import Label

FINALISTS = 4
CLOSE = 100.0
"""Fits whose leftovers are looked at: so many of least cost at least, and all within so much of the least, or within
twice the share that a further effect must earn: a simpler set may win although many cost less than it. So may a part
of the best that explains nearly all.
"""


@dataclass(frozen=True, eq=False)
class Decided:
    """A judgement with all that it rests on.

    Attributes:
        found: every fit of the search.
        left_of: what each finalist leaves over, by id(fit).
        freed: the baseline without what is stated of the values that it bends; None where it bends none.
        judgement: the decision, before the fit's own checks.
        withdrawn: sets that are not named, with the reason: an effect whose interval does not show it.
    """

    found: Found
    left_of: Mapping[int, Left]
    freed: Fit | None
    judgement: Judgement
    withdrawn: Mapping[Label, str] = field(default_factory=dict)

    @property
    def inflation(self) -> float:
        """By which differences of chi-squared are to be divided: noise level and colour."""
        return min(left.inflation for left in self.left_of.values())

    def but_for(self, failed: Sequence[str]) -> Judgement:
        """The decision when these checks have failed."""
        return judge(self.found, self.left_of, self.freed, failed, self.withdrawn) if failed else self.judgement

    def withdrawing(self, workshop: Workshop, why: str) -> Decided:
        """The decision without the set that was chosen."""
        withdrawn = {**self.withdrawn, self.judgement.chosen.hypothesis.label: why}
        left_of = {**_finalists(workshop, self.found, self.freed, withdrawn), **self.left_of}
        return replace(
            self,
            left_of=left_of,
            judgement=judge(self.found, left_of, self.freed, (), withdrawn),
            withdrawn=withdrawn,
        )

    def improved(self, workshop: Workshop, better: Fit) -> Decided:
        """The decision with the set that was chosen at a better minimum."""
        old = self.judgement.chosen
        if better.hypothesis.sites:
            self.found.keep(better)
        freed = self.freed if better.hypothesis.sites else better
        left_of = {key: left for key, left in self.left_of.items() if key != id(old)}
        left_of[id(better)] = workshop.left_by(better)
        said = judge(self.found, left_of, freed, (), self.withdrawn)
        return replace(self, left_of=left_of, freed=freed, judgement=said)


def conclude(pool: Pool, found: Found, report: Report) -> Decided:
    """Judge what was found.

    Args:
        pool: of the trials that were fitted.
        found: the fits; sets whose believed values bend are fitted again and take their places.
        report: told of progress.
    """
    rebased(pool, found, report)
    report("judging", 0, 1)
    freed = baseline_freed(pool, found.baseline)
    set_free(pool, found, report)
    left_of = _finalists(pool.workshop, found, freed)
    return Decided(found, left_of, freed, judge(found, left_of, freed, ()))


def _finalists(
    workshop: Workshop, found: Found, freed: Fit | None, withdrawn: Collection[Label] = ()
) -> dict[int, Left]:
    ranked = sorted((f for f in found.fits.values() if f.hypothesis.label not in withdrawn), key=lambda f: f.cost)
    least = found.best.cost
    reach = max(CLOSE, 2.0 * SMALL * (found.baseline.cost - least))
    slight = SLIGHT * (found.baseline.cost - least)
    ranked = [
        f
        for k, f in enumerate(ranked)
        if k < FINALISTS
        or f.cost < least + reach
        or (contains(found.best.hypothesis.label, f.hypothesis.label) and f.cost < least + slight)
    ]
    fits = [found.baseline, *ranked, *([freed] if freed is not None else [])]
    return {id(fit): workshop.left_by(fit) for fit in fits}
