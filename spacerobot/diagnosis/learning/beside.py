"""What stands beside a part's curve: its formula, effects that it makes idle, and those that show only beside it."""

from __future__ import annotations

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.learning.curves import Curve, from_where_it_is
from spacerobot.diagnosis.learning.describe import Described
from spacerobot.diagnosis.learning.part_form import written
from spacerobot.diagnosis.learning.weighed import curve_of, settled
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.model_choice import as_good, pays
from spacerobot.diagnosis.terms.candidates import redundant
from spacerobot.diagnosis.terms.decision import WORTH_OF_REST
from spacerobot.diagnosis.terms.hypothesis import Site

COMPANIONS = 2
"""Effects that may come to a curve."""


def without_curve(curve: Curve) -> list[Site]:
    """The effects beside a curve."""
    return [s for s in curve.fit.hypothesis.sites if not s.effect.learned]


def form_of(bench: Bench, curve: Curve) -> tuple[Described, Candidate] | None:
    """A curve's formula, and the model with it as unseen trials have it; None where none can be fitted."""
    found = written(bench, curve)
    return None if found is None else (found[0], bench.tested(found[1]))


def better_of(bench: Bench, curve: Curve) -> Candidate:
    """A curve's model, or its formula's where that predicts better."""
    one, form = bench.tested(curve.fit), form_of(bench, curve)
    return one if form is None or form[1].error > one.error else form[1]


def beside_it(growth: Growth, bench: Bench, curve: Curve, here: Candidate) -> Curve:
    """The curve with the effects that stand beside it: those that it makes idle go, and what shows beside it comes.

    Args:
        growth: of the part.
        bench: under the weights that the curve asks for.
        curve: beside what the catalogue had to offer.
        here: its better model, of `better_of`.
    """
    baseline = tested(bench, growth.before.fit)
    for _ in range(COMPANIONS + 1):
        curve, here = _without_idle(bench, curve, here, baseline)
        more = _companion(growth, bench, curve)
        if more is None or not pays(there := better_of(bench, more), here, bench.trials):
            break
        curve, here = more, there
    ended = settled(bench, without_curve(curve), from_where_it_is(curve))
    return curve if ended is None else ended


def _without_idle(bench: Bench, curve: Curve, here: Candidate, baseline: Candidate) -> tuple[Curve, Candidate]:
    for site in without_curve(curve):
        rest = [s for s in curve.fit.hypothesis.sites if s.label not in (site.label, curve.site.label)]
        less = settled(bench, rest, from_where_it_is(curve), listen=False)
        if less is not None and as_good(one := better_of(bench, less), here, baseline):
            curve, here = less, one
    return curve, here


def tested(bench: Bench, fit: Fit) -> Candidate:
    """A model of the catalogue under the bench's weights, tried on unseen trials."""
    return bench.tested(bench.again(fit))


def _companion(growth: Growth, bench: Bench, curve: Curve) -> Curve | None:
    """The curve beside the effect that promises most, where any promises as much as is worth naming."""
    here = curve.fit.hypothesis.sites
    further = [s for s in growth.sites if s not in here and not redundant([t.label for t in (*here, s)])]
    bar = (1.0 - WORTH_OF_REST) ** 2 * bench.left(curve.fit)
    promised = [p for p in bench.promises(curve.fit, further) if p.left < bar]
    fit = bench.fitted(curve.fit, min(promised, key=lambda p: p.left)) if promised else None
    if fit is None:
        return None
    sites = [s for s in fit.hypothesis.sites if not s.effect.learned]
    return settled(bench, sites, from_where_it_is(curve_of(curve.shape, curve.site, fit)), listen=False)
