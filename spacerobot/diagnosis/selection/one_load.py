"""What all parts feel together is one thing with one value: where the parts differ about how much of it there is, it is
none.

A load in the hand weighs the same at every joint. Joints whose links are not as the model has them find a mass each
that makes up for that, wherever it is put.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spacerobot.diagnosis.fitting.pooled import pooled
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.decision import GOOD_PART
from spacerobot.diagnosis.terms.hypothesis import Site


def at_odds(parts: Sequence[Part]) -> set[int]:
    """Which of a study's parts name what they feel together, where they differ about how much of it there is."""
    told: dict[tuple[str, str], dict[int, Site]] = {}
    for k, part in enumerate(parts):
        for site in part.fit.hypothesis.sites:
            if site.effect.together:
                told.setdefault(site.label, {})[k] = site
    return {k for by in told.values() if differ([(parts[k], site) for k, site in by.items()]) for k in by}


def differ(told: Sequence[tuple[Part, Site]]) -> bool:
    """Whether parts tell strengths that scatter by a good part of their mean, the surer ones counting for more."""
    found = []
    for part, site in told:
        key = site.key(site.effect.strength.name)
        low, high = part.fit.errors().get(key, (-np.inf, np.inf))
        found.append((part.fit.values()[key], 0.5 * abs(high - low)))
    sure = [pair for pair in found if np.isfinite(pair[1])]
    if len(sure) < 2:
        return False
    common = pooled(*zip(*sure, strict=True))
    return common.scatter > GOOD_PART * abs(common.value)
