"""One clock has one offset: what one part takes for a late sensor, the others that read it must bear out.

The joints of an arm share a log. A delay that explains one of them and none of the others is no clock's; a link on a
spring or a filter of its own may look like one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pooled import pooled
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.decision import MOVED
from spacerobot.diagnosis.terms.hypothesis import Site

Offset = tuple[float, float]
"""An offset and its standard error [s]."""


def not_borne_out(parts: Sequence[Part]) -> set[int]:
    """Which of a study's parts name an offset between clocks that the others, all together, exclude."""
    out = set()
    for site in {s.label: s for p in parts for s in p.fit.hypothesis.sites if s.effect.relative}.values():
        own = {k: said for k, p in enumerate(parts) if (said := _offset(p, site)) is not None}
        named = [k for k in own if site.label in parts[k].chosen.label]
        out |= {k for k in named if _excluded(k, own)}
    return out


def _excluded(k: int, own: Mapping[int, Offset]) -> bool:
    others = [said for j, said in own.items() if j != k]
    if not others:
        return False
    (value, error), rest = own[k], pooled(*zip(*others, strict=True))
    return bool(abs(value - rest.value) > MOVED * np.hypot(error, rest.error))


def _either_way(site: Site) -> Site:
    """Early as well as late: what tells against a delay is as good as what tells for it."""
    strength = site.effect.strength
    return replace(site, effect=site.effect.with_parameters((replace(strength, lower=-strength.upper),)))


def _offset(part: Part, site: Site) -> Offset | None:
    """What a part says of an offset, beside what it lacks; None where it does not read both clocks."""
    known = {s.label: s for s in part.growth.sites}
    channels = part.model.plain().sensors.get(site.where, ())
    if part.model.not_measured or not channels:
        return None
    for name, most in part.model.believed.within.items():
        if name.endswith(".delay"):  # of the log within its sample, which is later than its motion by so much
            torque = any(c.endswith(".torque") for c in channels)
            return part.fit.values()[name] * (1.0 if torque else -1.0), most / MOVED
    if site.label not in known:
        return None
    fit: Fit | None = part.fit
    if site.label not in part.chosen.label:
        sites = [s for s in part.fit.hypothesis.sites if not s.effect.relative]
        both = [*sites, _either_way(known[site.label])]
        fit = part.growth.bench.fitted_anyhow(part.fit, both, {}, "either way")
    key = site.key(site.effect.parameters[0].name)
    if fit is None or key not in (errors := fit.errors()):
        return None
    low, high = errors[key]
    return fit.values()[key], 0.5 * abs(high - low)
