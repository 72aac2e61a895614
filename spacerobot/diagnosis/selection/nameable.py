"""Which fits a verdict may name: the search asks before it spends time beside one, the judge before it ranks."""

from __future__ import annotations

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.selection.shown import held_by_bounds
from spacerobot.diagnosis.terms.candidates import means as signs_mean


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
