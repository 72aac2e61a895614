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
from spacerobot.effects.effect import said_name

Place = tuple[str, str]


def settled_by_others(parts: Sequence[Part]) -> list[Part]:
    """The parts, each concluded with what others show of what it feels too, where that predicts as well."""
    shown = [_shown(part) for part in parts]
    out = []
    for k, part in enumerate(parts):
        others = set[Place]().union(*(some for n, some in enumerate(shown) if n != k))
        felt = {s.label for s in part.growth.sites if (said_name(s.effect.name), s.where) in others}
        sets = [c.label for c in (part.chosen, *part.rivals)]
        if felt and not all(felt <= set(label) for label in sets):
            out.append(replace(part, growth=_with(part.growth, felt)))
        else:
            out.append(part)
    return out


def _shown(part: Part) -> set[Place]:
    """What a part names of what all feel, that no set which predicts as well is without."""
    shown: set[Place] = {(said_name(s.effect.name), s.where) for s in part.chosen.sites if s.effect.together}
    for rival in part.rivals:
        shown &= {(said_name(s.effect.name), s.where) for s in rival.sites}
    return shown


def _with(growth: Growth, known: set[Place]) -> Growth:
    """Concluded among sets that hold what is known, if one of them predicts as well as what was chosen."""
    weights = growth.bench.weights
    new = holding(growth, [s for s in growth.sites if s.label in known], "is without what another part shows")
    by = {c.label: c for c in new.considered}
    now, before = by.get(new.after.label), by.get(growth.after.label)
    if now is None or before is None or not known <= set(now.label):
        growth.bench.weights = weights
        return growth
    if not as_good(now, before, new.considered_baseline):
        growth.bench.weights = weights
        return growth
    return new
