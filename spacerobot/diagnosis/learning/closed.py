"""A curve's formulas, each fitted in the simulation itself, where everything else is free as well."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeAlias

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.learning.curves import Curve
from spacerobot.diagnosis.learning.describe import Described
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.formula import FormulaLaw
from spacerobot.support.errors import SimulationError

Form: TypeAlias = tuple[Described, Fit]
"""A formula, and the fit with it in the curve's place."""


def closed(
    curve: Curve, told: Iterable[Described], fitted: Callable[[Site, dict[str, float]], Fit | None]
) -> Form | None:
    """The formula that costs least, its numbers paid for, when the simulation fits it; None where it can fit none.

    Args:
        curve: what they are formulas of.
        told: formulas.
        fitted: fits one, at its place in the curve's stead, from start values by key.
    """
    values = curve.fit.values()
    tried: list[Form] = []
    for one in told:
        law, where = FormulaLaw(one.formula), curve.site.where
        fading = {p.name: values[curve.site.key(p.name)] for p in curve.site.effect.parameters if p.name in law.nulls}
        start = {k: v for k, v in values.items() if not k.startswith(curve.site.effect.name)}
        start |= {f"{law.name}@{where}.{k}": v for k, v in {**fading, **one.values}.items()}
        try:
            fit = fitted(Site(law, where), start)
        except SimulationError:
            continue
        if fit is not None:
            tried.append((one, fit))
    return min(tried, key=price, default=None)


def price(form: Form) -> float:
    """What a formula costs, its numbers paid for, in chi-squared."""
    told, fit = form
    return fit.cost + told.numbers * told.price
