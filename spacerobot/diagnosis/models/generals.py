"""General effects beside their special cases: friction of two levels beside friction of one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from spacerobot.diagnosis.candidates import CONTAINS
from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.hypothesis import Site
from spacerobot.diagnosis.models.bench import Bench
from spacerobot.diagnosis.models.chance import by_chance
from spacerobot.diagnosis.models.plausible import redundant

Known = Mapping[tuple[str, str], Site]
"""Sites by effect and place."""


def general_sites(special: Site, known: Known) -> Iterator[Site]:
    """Every effect at its place of which it is a special case."""
    for general, name in sorted(CONTAINS):
        if name == special.effect.name and (general, special.where) in known:
            yield known[general, special.where]


def inherited(new: Site, special: Site, fit: Fit) -> dict[str, float]:
    """Start values of a general effect: its special case's own where the units agree."""
    first = special.effect.parameters[0]
    value = fit.values()[special.key(first.name)]
    return {new.key(p.name): value if p.unit == first.unit else p.starts[0] for p in new.effect.parameters}


def not_excluded(bench: Bench, fit: Fit, known: Known) -> list[Fit]:
    """The fit with a general effect for each special case, where that costs less than chance would make it.

    An effect size says what is worth naming; where the noise is stated, the readings say what is not excluded.

    Args:
        bench: under the weights of the fit.
        fit: the chosen one.
        known: sites to take the general effects from.
    """
    out = []
    for special in fit.hypothesis.sites:
        for new in general_sites(special, known):
            sites = [new if s is special else s for s in fit.hypothesis.sites]
            if redundant(sites):
                continue
            found = bench.fitted_as(fit, sites, inherited(new, special, fit))
            spare = len(new.effect.parameters) - len(special.effect.parameters)
            if found is not None and not by_chance(fit.cost - found.cost, spare):
                out.append(found)
    return out


def wordings(chosen: Sequence[Site], known: Known) -> Iterator[list[tuple[Site, Site | None]]]:
    """Sets with as many parameters in which a general effect stands for its special case and others.

    Yields:
        The sites, each with the special case that it stands for, or None.
    """
    for special in chosen:
        for new in general_sites(special, known):
            spare = len(new.effect.parameters) - len(special.effect.parameters)
            rest = [s for s in chosen if s is not special]
            for left_out in rest:
                if len(left_out.effect.parameters) == spare:
                    yield [(new, special), *((s, None) for s in rest if s is not left_out)]
