"""What one part of a machine shows of what all feel together settles what another cannot tell.

A load that one joint cannot mistake is carried by the others too: there it is no longer one of two candidates beside a
sensor's scale, which alone does as well, but what is known, and the scale what it must do without.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from spacerobot.diagnosis.selection.forward_selection import holding
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.model_choice import as_good
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.candidates import by_name
from spacerobot.diagnosis.terms.hypothesis import Site

Place = tuple[str, str]
"""An effect, by the name that a verdict gives it, and where."""


def settled_by_others(parts: Sequence[Part]) -> list[Part]:
    """The parts, each concluded with what others show of what it feels too, where that predicts as well."""
    shown = [_shown(part) for part in parts]
    out = []
    for k, part in enumerate(parts):
        others = set[Place]().union(*shown[:k], *shown[k + 1 :])
        felt = [s for s in part.growth.sites if by_name([s.label])[0] in others]
        settled = all({s.label for s in felt} <= set(one.label) for one in (part.chosen, *part.rivals))
        out.append(part if settled else replace(part, growth=_with(part.growth, felt)))
    return out


def _shown(part: Part) -> set[Place]:
    """What a part names of what all feel, that no set which predicts as well is without."""
    return part.in_all & set(by_name([s.label for s in part.chosen.sites if s.effect.together]))


def _with(growth: Growth, known: Sequence[Site]) -> Growth:
    """Concluded among sets that hold what is known, if one of them predicts as well as what was chosen."""
    weights = growth.bench.weights
    new = holding(growth, known, "is without what another part shows")
    by = {c.label: c for c in new.considered}
    now, before = by.get(new.after.label), by.get(growth.after.label)
    if now is None or before is None or not {s.label for s in known} <= set(now.label):
        good = False
    else:
        good = as_good(now, before, new.considered_baseline)
    if not good:
        growth.bench.weights = weights
    return new if good else growth
