"""Which fits a verdict may name: that mean something, are what their effects' names say, and show it.

The search asks before it spends time beside one, the judge before it ranks. A strength says how much there is of an
effect (`Parameter.shape` is false), a shape how it acts. What cannot be shown of a strength cannot be shown of the
effect; a shape that lies at a bound drawn for the search's sake says that the recordings ask for another law.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.terms.candidates import means as signs_mean
from spacerobot.diagnosis.terms.candidates import redundant
from spacerobot.diagnosis.terms.decision import AT_BOUND, OUTER
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.effect import Parameter
from spacerobot.effects.sizes import Sizes

STEP = 0.05
"""Share of the largest displacement that lies between two readings of a fast motion."""

Ends = Mapping[str, tuple[float, float]]
"""Low and high ends of intervals by parameters' keys, physical."""


def at_bound(parameter: Parameter, value: float, error: tuple[float, float] | None = None) -> bool:
    """Whether a value sits at a bound drawn for the search: not nothing (its null, or zero), and not infinity.

    Args:
        parameter: whose bounds.
        value: fitted.
        error: its ends one standard error away; a bound that lies between them holds the value, not the recordings.
    """
    bounds = [b for b in (parameter.lower, parameter.upper) if math.isfinite(b) and b not in (0.0, parameter.null)]
    low, high = error or (value, value)
    return any(abs(value - bound) <= AT_BOUND * abs(bound) or low <= bound <= high for bound in bounds)


def held_by_bounds(site: Site, values: Mapping[str, float], errors: Ends | None = None) -> str:
    """Why a fitted effect is not shown, as far as its values tell; empty where nothing speaks against it.

    Args:
        site: the effect at its place.
        values: of its parameters, by key, in their own units.
        errors: the values one standard error below and above, by key, where these are known.
    """
    for p in site.effect.parameters:
        key = site.key(p.name)
        if key in values and at_bound(p, values[key], (errors or {}).get(key)):
            return f"{key} sits at its bound, {values[key]:.4g} {p.unit}"
    return ""


def not_shown(site: Site, values: Mapping[str, float], intervals: Ends) -> str:
    """Why an effect is not to be named; empty where it is shown.

    Args:
        site: the effect at its place.
        values: of its parameters, by key, in their own units.
        intervals: their 95 % intervals (low, high), by key; a parameter without one is judged by its value alone.

    Returns:
        one clause: its interval holds nothing, spans its range, or it sits at its bound.
    """
    held = held_by_bounds(site, values)
    if held:
        return held
    strengths = [p for p in site.effect.parameters if not p.shape]
    for p in strengths:
        low, high = intervals.get(site.key(p.name), (math.nan, math.nan))
        if low <= p.lower and high >= p.upper:
            return f"the interval of {site.key(p.name)} spans its range, {p.lower:.4g} to {p.upper:.4g} {p.unit}"
    known = [(p, intervals[site.key(p.name)]) for p in strengths if site.key(p.name) in intervals]
    if known and all(low <= p.null <= high for p, (low, high) in known):
        p, (low, high) = known[0]
        return f"the interval of {site.key(p.name)}, {low:.4g} to {high:.4g} {p.unit}, holds nothing ({p.null:.4g})"
    return ""


def means(fit: Fit) -> bool:
    """Whether a fit's signs make physical sense."""
    return signs_mean(fit.hypothesis.label, fit.values())


def held_labels(fit: Fit) -> set[tuple[str, str]]:
    """The effects of a fit that a bound holds."""
    values, errors = fit.values(), fit.errors()
    return {site.label for site in fit.hypothesis.sites if held_by_bounds(site, values, errors)}


def held(fit: Fit) -> bool:
    """Whether a bound holds one of a fit's effects."""
    return bool(held_labels(fit))


def nameable(fit: Fit) -> bool:
    """Whether a fit means something and shows it."""
    return means(fit) and not held(fit)


def why_nameless(fit: Fit, implausible: Callable[[Fit], str]) -> str:
    """Why a fit may not be named as it stands, one clause; empty where nothing speaks against it."""
    if not means(fit):
        return "its sign makes no physical sense: a stream would be read before it happens"
    values, errors = fit.values(), fit.errors()
    for site in fit.hypothesis.sites:
        for p in site.effect.parameters:
            key = site.key(p.name)
            if key in values and at_bound(p, values[key], errors.get(key)):
                return f"a bound of what is looked for holds its {p.name}"
    return implausible(fit)


def reached(sites: Sequence[Site], values: Mapping[str, float], visited: Callable[[str], np.ndarray]) -> bool:
    """Whether every place came up to the displacement at which its effect begins.

    A joint that was read about 0 and about 1.4 rad, and at nothing between, says nothing of a stop at 0.8: the gap in
    its readings there must be no wider than what was seen beyond, or than a step of a motion. Nor is it a stop that
    leaves its place less than half of its way.

    Args:
        sites: effects at their places.
        values: of their parameters, by key.
        visited: displacements at which a place was read, shape (T,).
    """
    for site in sites:
        for edge in (values[site.key(p.name)] for p in site.effect.parameters if p.reach):
            seen, edge = site.effect.towards(visited(site.where)), float(site.effect.towards(np.array(edge)))
            if seen.size and edge < seen.max() - (1.0 - OUTER) * (seen.max() - min(seen.min(), 0.0)):
                return False
            inside, beyond = seen[seen <= edge], seen[seen > edge]
            if inside.size and beyond.size:
                widest = max(float(np.ptp(beyond)), STEP * float(np.abs(seen).max()))
                if float(beyond.min() - inside.max()) > widest:
                    return False
    return True


def only_way(site: Site, start: Mapping[str, float], sizes: Sizes) -> float:
    """1 or -1 where there is an effect with more of its strength, from nothing towards its start (by key), or less; 0
    if both.

    Less mass than believed is no payload, and friction does not push.
    """
    p, own = site.effect.strength, site.own(start)
    back = 2.0 * p.null - own[p.name]
    there = not site.effect.implausible(own, sizes)
    other = p.lower <= back <= p.upper and not site.effect.implausible({**own, p.name: back}, sizes)
    return float(there) - float(other)


def implausible(sites: Sequence[Site], values: Mapping[str, float], size_at: Callable[[str], Sizes]) -> str:
    """Why effects, with their fitted numbers, are not what their names say, one clause; empty where they are."""
    if redundant([s.label for s in sites]):
        return "two laws of one thing at one place"
    for site in sites:
        if why := site.effect.implausible(site.own(values), size_at(site.where)):
            return why
    return ""
