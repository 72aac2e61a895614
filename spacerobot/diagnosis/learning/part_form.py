"""A part's curve in a formula, fitted in the part's own simulation."""

from __future__ import annotations

from dataclasses import replace

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.learning.closed import Form, closed
from spacerobot.diagnosis.learning.curves import Curve
from spacerobot.diagnosis.learning.describe import describe
from spacerobot.diagnosis.learning.ground import visited
from spacerobot.diagnosis.selection.bench import STEPS, Bench
from spacerobot.diagnosis.terms.hypothesis import Site, hypothesis

WORDINGS = 3
"""Formulas, those nearest to the curve, that are fitted in the simulation."""


def written(bench: Bench, curve: Curve) -> Form | None:
    """The formula that costs least in a part's simulation; None where it can fit none."""
    others = [s for s in curve.fit.hypothesis.sites if not s.effect.learned]
    told = sorted(describe(curve, wider=True), key=lambda one: one.off)[:WORDINGS]
    if curve.shape.of == "q":  # known wherever it went, not over one period alone
        low, high = visited(bench, curve.fit, curve.site.where)["d"]
        told = [replace(one, formula=replace(one.formula, low=low, high=high)) for one in told]

    def fitted(site: Site, start: dict[str, float]) -> Fit | None:
        made = hypothesis(bench.model.believed, [*others, site], start)
        return bench.fitter().fit(
            made, warm=start, initials=curve.fit.initials(), max_iterations=2 * STEPS, robust=False
        )

    return closed(curve, told, fitted)
