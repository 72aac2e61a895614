"""One effect in the place of several wrong values: a scale that all of them had made up for.

Unseen trials are foretold as well by either, and what is stated of the values tells them apart.
"""

from __future__ import annotations

from collections.abc import Container, Sequence

from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.judge import moved
from spacerobot.diagnosis.selection.model_choice import ratio
from spacerobot.diagnosis.selection.penalty import instead_of_values, score
from spacerobot.diagnosis.selection.without_prior import let_go
from spacerobot.diagnosis.terms.candidates import redundant
from spacerobot.diagnosis.terms.decision import TIE
from spacerobot.diagnosis.terms.hypothesis import Label, Site, label_of

MOST = 4
"""Effects that are fitted, those first that promise most."""


def instead(bench: Bench, one: Candidate, sites: Sequence[Site], barred: Container[Label] = ()) -> list[Candidate]:
    """Sets with one effect more that put back every value that a candidate's fit moves, for less, and foretell unseen
    trials as well; best first.

    Last the candidate itself, without what is stated of these values; empty where no effect does as well as that.

    Args:
        bench: under the weights of the fit.
        one: as fitted with what is stated.
        sites: effects and places on offer.
        barred: sets that take no part.
    """
    freed = let_go(one.fit, moved(one.fit), bench.freed)
    if freed is None:
        return []
    bar = instead_of_values(score(freed), len(freed.hypothesis.freed))
    further = [s for s in sites if s.label not in one.label and not redundant([*one.label, s.label])]
    further = [s for s in further if label_of([*one.sites, s]) not in barred]
    found = []
    for promise in bench.gains(one.fit, further)[:MOST]:
        fit = bench.fitted(one.fit, promise)
        if fit is not None and not moved(fit) and score(fit) < bar:
            found.append(fit)
    *others, values = (bench.tested(fit) for fit in (*sorted(found, key=score), freed))
    as_well = [other for other in others if ratio(other, values) < 1.0 + TIE]
    return [*as_well, values] if as_well else []
