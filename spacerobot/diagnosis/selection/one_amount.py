"""What all parts feel together is one thing with one value: where the parts differ about how much of it there is, it is
none.

A load in the hand weighs the same at every joint, a base leans by the same angle. Joints whose links are not as the
model has them find a mass each that makes up for that, wherever it is put.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pooled import pooled
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.decision import GOOD_PART
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.effect import said_name


def at_odds(parts: Sequence[Part]) -> dict[tuple[str, str], set[int]]:
    """What some of a study's parts name of what they feel together, effect and place, where all differ about how much
    of it there is; and which of them do.

    A part that feels it and does not name it tells how much there is beside what it does name.
    """
    told: dict[tuple[str, str], dict[int, Site]] = {}
    for k, part in enumerate(parts):
        for site in part.fit.hypothesis.sites:
            if site.effect.together:
                told.setdefault(site.label, {})[k] = site
    out: dict[tuple[str, str], set[int]] = {}
    for (name, where), by in told.items():
        site = next(iter(by.values()))
        fits = [parts[k].fit for k in by]
        for part in (p for k, p in enumerate(parts) if k not in by and where in p.model.shared):
            bench = part.growth.bench
            fits += [f for f in [bench.fitted_anyhow(part.fit, (*part.fit.hypothesis.sites, site), {})] if f]
        if differ(fits, site):
            out[said_name(name), where] = set(by)
    return out


def differ(fits: Sequence[Fit], site: Site) -> bool:
    """Whether fits tell strengths of a site that scatter by a good part of their mean, the surer counting for more."""
    key, found = site.key(site.effect.strength.name), []
    for fit in fits:
        low, high = fit.errors().get(key, (-np.inf, np.inf))
        found.append((fit.values()[key], 0.5 * abs(high - low)))
    sure = [pair for pair in found if 0.0 < pair[1] < np.inf]  # of what a part does not feel at all it tells nothing
    if len(sure) < 2:
        return False
    common = pooled(*zip(*sure, strict=True))
    return common.scatter > GOOD_PART * abs(common.value)
