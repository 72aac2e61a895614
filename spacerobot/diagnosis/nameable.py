"""Which fits a verdict may name: the search asks before it spends time beside one, the judge before it ranks."""

from __future__ import annotations

from spacerobot.diagnosis.candidates import plausible
from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.shown import held_by_bounds


def means(fit: Fit) -> bool:
    """Whether a fit's signs make physical sense."""
    return plausible(fit.hypothesis.label, fit.values())


def held(fit: Fit) -> bool:
    """Whether a bound holds one of a fit's effects."""
    values, errors = fit.values(), fit.errors()
    return any(held_by_bounds(site, values, errors) for site in fit.hypothesis.sites)


def nameable(fit: Fit) -> bool:
    """Whether a fit means something and shows it."""
    return means(fit) and not held(fit)
