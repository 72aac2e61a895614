"""How sure the place is of a load that all parts feel together, and how much of it there is beside.

Parts are fitted with the shape held where all of them together found it, so what each says of the strength is as if the
place were known. All parts' readings tell both, beside what each part fits itself (Gauss-Newton's normal matrix, each
part's own parameters taken out; Seber and Wild 1989, Nonlinear Regression, ch. 5).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from dataclasses import replace as changed

import numpy as np
from msgspec.structs import replace

from spacerobot.diagnosis.answer.agreed import error_of, within
from spacerobot.diagnosis.answer.record import Effect
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.screen import Projector, Screener
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.selection.shared_sources import without
from spacerobot.diagnosis.terms.hypothesis import Site, hypothesis
from spacerobot.effects.effect import said_name
from spacerobot.effects.form import FormOf
from spacerobot.effects.settled import form_of
from spacerobot.support.errors import SimulationError

STEP = 1e-3
"""By which numbers of a shape are moved to either side [m]: names hold a thousandth of it."""

SURE = 1e-9
"""Share of the largest direction below which readings tell nothing of one."""


@dataclass(frozen=True, eq=False)
class Spread:
    """Standard errors, with readings' noise as the parts have it.

    Attributes:
        wider: by how much the strength's is wider than it is in a shape that is held.
        held: the strength's own in a shape that is held.
        shape: of each number of the shape; infinite where nothing tells.
    """

    wider: float
    held: float
    shape: dict[str, float]


def with_shapes(effects: Sequence[Effect], parts: Sequence[Part]) -> list[Effect]:
    """The same effects; where a shape was found, with intervals for it, and the strength's as wide as it asks."""
    found: dict[tuple[str, str], list[tuple[Bench, Fit, Site]]] = {}
    for part in parts:
        for site in part.fit.hypothesis.sites:
            if site.effect.together == "point" and site.effect.settings:
                place = said_name(site.effect.name), site.where
                found.setdefault(place, []).append((part.growth.bench, part.fit, site))
    return [_widened(one, found[place]) if (place := (one.effect, one.where)) in found else one for one in effects]


def _widened(one: Effect, told: Sequence[tuple[Bench, Fit, Site]]) -> Effect:
    (*_, first), *_ = told
    strength, spread = first.effect.strength.name, spread_of(told)
    error = error_of(one.parameters[strength])
    if not np.isfinite(error):
        return one
    scale = error / spread.held
    wider = {strength: error * spread.wider}
    wider |= {name: scale * own for name, own in spread.shape.items() if np.isfinite(own)}
    return replace(one, parameters={n: within(v, wider[n]) if n in wider else v for n, v in one.parameters.items()})


def spread_of(told: Sequence[tuple[Bench, Fit, Site]]) -> Spread:
    """Of one effect, by the fits of all parts that name it."""
    (*_, first), *_ = told
    names = list(first.effect.settings)
    normal = np.sum([_normal(*one) for one in told], axis=0)
    size = np.sqrt(np.maximum(np.diag(normal), 0.0))
    seen = size > SURE * size[0]  # numbers of a shape are of the order of its strength's own share of them
    unit = np.where(seen, size, 1.0)
    cov = np.linalg.pinv(normal / np.outer(unit, unit), rcond=SURE, hermitian=True) / np.outer(unit, unit)
    errors = [float(np.sqrt(cov[k, k])) if seen[k] else np.inf for k in range(1, len(names) + 1)]
    held = 1.0 / float(unit[0])
    wider = max(float(np.sqrt(cov[0, 0])) / held, 1.0)
    return Spread(wider, held, dict(zip(names, errors, strict=True)))


def _normal(bench: Bench, fit: Fit, site: Site) -> np.ndarray:
    """Normal matrix of an effect's strength and the numbers of its shape, all else that a part fits taken out."""
    fitter, made = bench.fitter(), fit.hypothesis
    key = site.key(site.effect.strength.name)
    k = next(n for n, free in enumerate(made.free) if free.key == key)
    project = Projector(fitter, fit, Screener(fitter, bench.model.believed).state_of(fit), robust=False)

    def raw(shape: Mapping[str, float]) -> np.ndarray:
        assert isinstance(site.effect, FormOf)
        other = changed(site, effect=site.effect.plain.in_form(form_of(shape.values())))
        values = {other.key(name): value for name, value in site.own(fit.values()).items()}
        sites = [other if s is site else s for s in made.sites]
        again = hypothesis(bench.model.believed.free_of(made.freed), sites, values)
        state = fitter.state(again, again.start({**fit.values(), **values}), fit.initials())
        if state is None:
            raise SimulationError("a shape near the one found cannot be simulated")
        return project.stack(state.raw)

    settled = {name: float(x) for name, x in site.effect.settings.items()}
    columns = []
    for name, x in settled.items():
        more, less = (raw({**settled, name: x + step}) for step in (STEP, -STEP))
        columns.append((more - less) / (2.0 * STEP))
    whole = project.beside(columns)
    rate = made.free[k].slope(float(fit.z[k]))
    whole[k] /= rate
    whole[:, k] /= rate
    kept = [k, *range(len(made.free), whole.shape[0])]
    others = [row for n, row in enumerate(np.eye(whole.shape[0])) if n not in kept]
    freed, _ = without(whole, np.zeros(whole.shape[0]), others)
    return freed[np.ix_(kept, kept)]
