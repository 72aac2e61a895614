"""Fits that are no physics: signs and sizes that an effect's name would not survive."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from spacerobot.diagnosis.terms.candidates import redundant
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.sizes import Sizes


def plausible(sites: Sequence[Site], values: Mapping[str, float], size_at: Callable[[str], Sizes]) -> bool:
    """Whether every effect, with its fitted numbers, is what its name says, and no place has two laws of one thing."""
    if redundant([s.label for s in sites]):
        return False
    return all(
        site.effect.plausible({p.name: values[site.key(p.name)] for p in site.effect.parameters}, size_at(site.where))
        for site in sites
    )
