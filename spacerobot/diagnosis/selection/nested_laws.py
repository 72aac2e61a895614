"""General effects beside their special cases: friction of two levels beside friction of one."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from spacerobot.diagnosis.fitting.fitted import NORMAL_95, Fit
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.terms.candidates import redundant, refines
from spacerobot.diagnosis.terms.decision import CHANCE, SMALL, TWICE
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.effect import Parameter, said_name


def by_chance(gain: float, parameters: int, looks: int = 1) -> bool:
    """Whether so many further parameters that mean nothing may well lower chi-squared by so much (Wilks).

    Args:
        gain: what chi-squared comes down by.
        parameters: how many more there are.
        looks: effects and places that were tried and of which this is the best (Sidak).
    """
    return gain <= chance_edge(parameters, looks)


def chance_edge(parameters: int, looks: int = 1) -> float:
    """The fall of chi-squared that `by_chance` takes for chance's at most."""
    return float(chdtri(parameters, -math.expm1(math.log1p(-CHANCE) / max(looks, 1))))


Known = Mapping[tuple[str, str], Site]
"""Sites by effect and place."""


def general_sites(special: Site, known: Known) -> Iterator[Site]:
    """Every effect at its place of which it is a special case."""
    for (general, where), site in sorted(known.items()):
        if where == special.where and refines(general, special.effect.name):
            yield site


def special_sites(general: Site, known: Known) -> Iterator[Site]:
    """Every effect at its place that is a special case of it."""
    for (special, where), site in sorted(known.items()):
        if where == general.where and refines(general.effect.name, special):
            yield site


def level_of(special: Site, general: Site, fit: Fit) -> dict[str, float]:
    """Start values of a special case: the mean of what a fit of the general law has in the unit of its strength."""
    strength, values = special.effect.strength, fit.values()
    alike = [values[general.key(p.name)] for p in general.effect.parameters if p.unit == strength.unit]
    return {special.key(strength.name): float(np.mean(alike))} if alike else {}


def inherited(new: Site, special: Site, fit: Fit) -> dict[str, float]:
    """Start values of a general effect: its special case's own of the same name, or its first where the units agree.

    How it acts otherwise is, of its starts, as near as may be to where it is that special case.
    """
    own = special.own(fit.values())
    first = special.effect.parameters[0]
    return {
        new.key(p.name): own.get(p.name, own[first.name] if p.unit == first.unit else _nearest(p, new.effect.limits))
        for p in new.effect.parameters
    }


def _nearest(p: Parameter, limits: Mapping[str, float]) -> float:
    """The start nearest to a limit; the first of a parameter that has none."""
    return min(p.starts, key=lambda start: abs(math.log(start / limits[p.name]))) if p.name in limits else p.starts[0]


def not_excluded(bench: Bench, fit: Fit, known: Known) -> list[Fit]:
    """The fit with a general effect for each special case, where the readings do not exclude it.

    An effect size says what is worth naming; where the noise is stated, the readings say what is not excluded: a
    general effect that costs less than chance would make it and is another than its special case, and one of which they
    leave open whether a level is twice the other.

    Args:
        bench: under the weights of the fit.
        fit: the chosen one.
        known: sites to take the general effects from.
    """
    out = []
    for special in fit.hypothesis.sites:
        for new in general_sites(special, known):
            sites = [new if s is special else s for s in fit.hypothesis.sites]
            another = said_name(new.effect.name) != said_name(special.effect.name)  # a form of it says the same
            if redundant([s.label for s in sites]) or not another:
                continue
            found = bench.fitted_as(fit, sites, inherited(new, special, fit))
            spare = len(new.effect.parameters) - len(special.effect.parameters)
            if found is None:
                continue
            meant = not by_chance(fit.cost - found.cost, spare) and is_another(bench, fit, special, found)
            if meant or left_open(found, new):
                out.append(found)
    return out


def is_another(bench: Bench, fit: Fit, special: Site, found: Fit) -> bool:
    """Whether a general law's fit differs from its special case's by more than a law's own small defects.

    Levels of friction that differ by a hundredth are one level, however surely they differ: models of arms err by more.

    Args:
        bench: under the weights of both fits.
        fit, special: the special case's fit, and its site there.
        found: the fit with the general law in its place.
    """
    strength = special.effect.strength
    at = fit.hypothesis.keys.index(special.key(strength.name))
    z = fit.z.copy()
    z[at] = fit.hypothesis.free[at].z(strength.null)
    without = bench.fitter().state(fit.hypothesis, np.clip(z, *fit.hypothesis.bounds()), fit.initials())
    if without is None:
        return True
    own = _square(fit.residuals(), without.raw, without.keep)
    return _square(fit.residuals(), found.residuals(), without.keep) > SMALL * own


def _square(one: Mapping[str, np.ndarray], other: Mapping[str, np.ndarray], keep: Mapping[str, np.ndarray]) -> float:
    return float(sum(np.square((one[k] - other[k])[good]).sum() for k, good in keep.items()))


def left_open(fit: Fit, general: Site) -> bool:
    """Whether the 95 % interval of an effect's two levels has one twice the other in it.

    Only of effects that are two levels and nothing else: what has a scale of its own as well, as the speed at which
    friction falls, can always lie where nothing has been.
    """
    apart = _apart(fit, general)
    return apart is not None and apart.difference + NORMAL_95 * apart.deviation > TWICE * apart.mean


def least_alike(fit: Fit) -> Fit:
    """The fit with its two levels as far apart as their 95 % interval allows, everything else following them.

    At its best such a fit may be the special case itself; what a further trial is to tell apart lies at this end. To
    first order in the free parameters; the trials' own initial values stay.
    """
    for site in fit.hypothesis.sites:
        apart = _apart(fit, site)
        if apart is not None and apart.deviation > 0.0:
            low, high = fit.hypothesis.bounds()
            z = fit.z + NORMAL_95 / apart.deviation * apart.direction
            fit = replace(fit, z=np.clip(z, low, high))
    return fit


@dataclass(frozen=True, eq=False)
class _Apart:
    """Two levels: their mean, how far they are apart, that number's standard deviation, and its covariance with z."""

    mean: float
    difference: float
    deviation: float
    direction: np.ndarray


def _apart(fit: Fit, general: Site) -> _Apart | None:
    keys = [general.key(p.name) for p in general.effect.parameters]
    if fit.covariance is None or len(keys) != 2 or len({p.unit for p in general.effect.parameters}) > 1:
        return None
    at = [fit.hypothesis.keys.index(k) for k in keys]
    free = [fit.hypothesis.free[i] for i in at]
    one, other = (f.value(float(fit.z[i])) for i, f in zip(at, free, strict=True))
    slope = np.array([f.slope(float(fit.z[i])) for i, f in zip(at, free, strict=True)])
    slope[int(one >= other)] *= -1.0  # of the greater level over the other
    direction = fit.covariance[:, at] @ slope
    return _Apart(0.5 * (one + other), abs(one - other), float(np.sqrt(max(slope @ direction[at], 0.0))), direction)


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
