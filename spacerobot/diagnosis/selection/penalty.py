"""How fits of unlike size are weighed: what an effect's parameters cost, and what a further effect must earn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.terms.candidates import contains

PENALTY = 8.0
"""Cost of one effect parameter: the look over forty effects finds a chance fall of chi-squared of this size."""

MARGIN = 10.0
"""Lead below which two sets cannot be told apart, odds of 150 to 1; and which a set must have over a part of it."""

SMALL = 1e-3
"""Share of what a law explains that a richer one in its place, or a further effect beside it, may owe to the law's own
small defects: a law that is wrong by three per cent of its force.
"""

SLIGHT = 0.05
"""That share for a further effect where the simpler set leaves nothing but noise. Between either and what statistics
ask for, the two are not told apart: with many samples a harmless defect of the first law is always significant.
"""

STAND_IN = 1.0 / 64.0
"""Share of what a law explains that its own defect may cost, and so misplace its numbers, where it stands for a
richer one: a law wrong by an eighth of its force. Measured on the sealed servo arms of docs/proof_records.jsonl and of
the batch after it: one mode for seven joints costs up to so much at its true mass and damping in 39 of 40, up to a
hundredth in 33.
"""


def score(fit: Fit, inflation: float = 1.0) -> float:
    """Penalised cost in units of the noise as it is."""
    count = sum(1 for f in fit.hypothesis.free if f.kind == "effect")
    count += sum(1 for s in fit.hypothesis.sites if s.trials)  # which trial was a choice too
    count += len(fit.hypothesis.freed)  # a belief that is given up
    return fit.cost / inflation + PENALTY * count


def simplest(ranked: Sequence[Fit], scores: Mapping[int, float]) -> Fit:
    """The best, unless a special case of it does nearly as well.

    Args:
        ranked: fits, best first.
        scores: penalised costs by id(fit).
    """
    best = ranked[0]
    for fit in ranked[1:]:
        if contains(best.hypothesis.label, fit.hypothesis.label) and scores[id(fit)] - scores[id(best)] < MARGIN:
            best = fit
    return best


def defect(special: Fit, general: Fit, explained: float, adequate: bool) -> float:
    """Fall of the penalised cost up to which all that a set earns over a part of it may be a defect of the part's law.

    Args:
        special: the part.
        general: the set that holds it.
        explained: what the part earns over the baseline.
        adequate: whether the part leaves nothing but noise.
    """
    fewer = len(special.hypothesis.sites) < len(general.hypothesis.sites)
    more_to_it = any(s.effect.stands_for for s in special.hypothesis.sites)
    return (SLIGHT if fewer and (adequate or more_to_it) else SMALL) * max(explained, 0.0)
