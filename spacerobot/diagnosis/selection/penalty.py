"""How fits of unlike size are weighed: what an effect's parameters cost, and what a further effect must earn."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.terms.candidates import contains
from spacerobot.diagnosis.terms.decision import FEW, MARGIN, PENALTY, SLIGHT, SMALL


def score(fit: Fit, inflation: float = 1.0) -> float:
    """Penalised cost in units of the noise as it is."""
    count = sum(1 for f in fit.hypothesis.free if f.kind == "effect")
    count += sum(1 for s in fit.hypothesis.sites if s.trials)  # which trial was a choice too
    chosen = sum(math.log(s.effect.choices) for s in fit.hypothesis.sites)  # each form as likely as the others
    return priced(fit, inflation) + PENALTY * count + 2.0 * chosen


def priced(fit: Fit, inflation: float = 1.0) -> float:
    """Its cost with what it gives up of what is believed; effects are not counted."""
    return fit.cost / inflation + PENALTY * len(fit.hypothesis.freed)


def instead_of_values(at_will: float, wrong: int) -> float:
    """Penalised cost below which one effect may be meant in the place of so many wrong values, which cost `at_will`.

    One thing that is missing is no less likely than two values that are both stated wrongly; beside one wrong value it
    must cost clearly less.
    """
    return at_will - (0.0 if wrong >= FEW else MARGIN)


def simplest(
    ranked: Sequence[Fit], scores: Mapping[int, float], nothing: float, adequate: Callable[[Fit], bool]
) -> Fit:
    """The best, unless a special case of it does nearly as well.

    Where that leaves nothing but noise, a small share of all that it explains may be its own law's defect.

    Args:
        ranked: fits, best first.
        scores: penalised costs by id(fit).
        nothing: of the baseline.
        adequate: whether a fit leaves nothing but noise; asked only where it matters.
    """
    best = ranked[0]
    for fit in ranked[1:]:
        if not contains(best.hypothesis.label, fit.hypothesis.label):
            continue
        behind = scores[id(fit)] - scores[id(best)]
        if behind < MARGIN or (behind < lead_over(nothing - scores[id(fit)]) and adequate(fit)):
            best = fit
    return best


def lead_over(explained: float) -> float:
    """Lead that a set must have over a part of it that explains so much and leaves nothing but noise."""
    return max(MARGIN, SMALL * explained)


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
