"""One fold: everything decided again without some trials, and these predicted.

Nothing here knows the trials that are left out before they are predicted: the rig as believed is fitted to the others,
the sets in play are fitted from starts that these lead to, and the same judge decides. What is not shown is taken
back, by the curvature of the fold's fits.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.selection.decide import conclude
from spacerobot.diagnosis.selection.intervals import curved
from spacerobot.diagnosis.selection.refit import refit
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.selection.unseen import Foretold, foretell, seen_sites
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.hypothesis import Site, label_of
from spacerobot.diagnosis.terms.kinds import OPEN, OTHER, PART, SAME, LeadsTo
from spacerobot.support.errors import SimulationError


@dataclass(frozen=True)
class Fold:
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

    def as_json(self) -> dict[str, Any]:
        """For a store."""
        told = {k: getattr(self, k).as_json() for k in ("before", "after", "selected")}
        rivals = [r.as_json() for r in self.rivals]
        return {"out": list(self.out), "leads_to": self.leads_to, **told, "rivals": rivals}

    @classmethod
    def from_json(cls, kept: Mapping[str, Any]) -> Fold:
        """Of `as_json`, or of what a store has made of it."""
        told = {k: Foretold.from_json(kept[k]) for k in ("before", "after", "selected")}
        rivals = tuple(Foretold.from_json(r) for r in kept["rivals"])
        return cls(tuple(kept["out"]), leads_to=cast(LeadsTo, kept["leads_to"]), rivals=rivals, **told)


def folded(
    workshop: Workshop, out: tuple[str, ...], chosen: Sequence[Site], rivals: Sequence[Sequence[Site]], thorough: bool
) -> dict[str, Any]:
    """A fold, as JSON.

    Args:
        workshop: of all trials.
        out: trials to leave out.
        chosen: the set that was chosen on all trials.
        rivals: further sets that the fold chooses among.
        thorough: whether they are fitted from more starts where the first ones explain little.
    """
    unseen = [t for t in workshop.trials if t.id in out]
    sites = seen_sites(chosen, out)
    label = label_of(sites)
    try:
        with Pool(workshop.but_for(out), 1) as pool:
            found = refit(pool, sites, [seen_sites(r, out) for r in rivals], thorough)
            decided = curved(pool.workshop, conclude(pool, found, lambda what, done, total: None))
    except SimulationError as error:
        none = Foretold((), failed={t.id: str(error) for t in unseen})
        return Fold(out, none, none, none, OTHER, (none,) * len(rivals)).as_json()
    said = decided.judgement
    best = said.chosen.hypothesis.label
    after = said.chosen if best == label else _fit_of(found, sites)
    others = [_fit_of(found, seen_sites(r, out)) for r in rivals]
    told = {id(f): foretell(workshop.model, f, unseen) for f in (found.baseline, after, said.chosen, *others)}
    leads_to: LeadsTo
    if best == label:
        leads_to = SAME
    elif any(f.hypothesis.label == label for f in said.alternatives):
        leads_to = OPEN
    else:
        leads_to = PART if contains(label, best) else OTHER
    rest = tuple(told[id(f)] for f in others)
    return Fold(out, told[id(found.baseline)], told[id(after)], told[id(said.chosen)], leads_to, rest).as_json()


def _fit_of(found: Found, sites: Sequence[Site]) -> Fit | None:
    label = label_of(sites)
    return found.fits.get(label) if label else found.baseline
