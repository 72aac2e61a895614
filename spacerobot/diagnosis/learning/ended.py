"""A rig's curve learned to its end and written down, each begun where the other ended.

A curve stays in the first minimum that it meets: one that holds back at first, so that a contact begins later, is made
up for by where each target stood. Its formula cannot do that, ends elsewhere, and fits better than the curve that it
was read off, although a curve can be everything that a formula is. So the curve goes on from there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.learning.closed import Form, closed, price
from spacerobot.diagnosis.learning.curves import Begun, Curve, finished
from spacerobot.diagnosis.learning.describe import Described, describe
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.formula import FormulaLaw


def ended(workshop: Workshop, curve: Curve, beside: Fit) -> tuple[Curve, Form | None]:
    """The curve fitted to its end, and its formula that costs least; None where none can be fitted.

    Args:
        workshop: of the trials to fit.
        curve: at the noise as it is.
        beside: whose effects stay.
    """
    curve = finished(workshop, curve, beside)
    told = describe(curve)
    form = written(workshop, curve, told)
    if form is None or form[1].chi2 >= curve.fit.chi2:
        return curve, form
    again = finished(workshop, curve, beside, laid_on(curve, form[1]))
    if again is curve:
        return curve, form
    known = {_words(one) for one in told}
    other = written(workshop, again, [one for one in describe(again) if _words(one) not in known])
    return again, form if other is None else min(form, other, key=price)


def _words(told: Described) -> tuple[str, ...]:
    return tuple(word for word, _ in told.formula.words)


def written(workshop: Workshop, curve: Curve, told: Sequence[Described]) -> Form | None:
    """The formula of a curve that costs least in the simulation."""
    sites, only = curve.fit.hypothesis.sites, curve.fit.hypothesis.only

    def fitted(site: Site, start: dict[str, float]) -> Fit | None:
        label = tuple(site.label if s.label == curve.site.label else s.label for s in sites)
        return workshop.run(Task(label, start, curve.fit.initials(), only=only))

    return closed(curve, told, fitted)


def laid_on(curve: Curve, fit: Fit) -> Begun:
    """From where the curve begins that says what a fitted formula of it does."""
    shape, values = curve.shape, fit.values()
    (site,) = (s for s in fit.hypothesis.sites if s.effect.learned)
    law = site.effect
    assert isinstance(law, FormulaLaw)
    told = {p.name: values[site.key(p.name)] for p in law.parameters}
    places = shape.closely
    found = np.linalg.lstsq(shape.rows(places), law.shape.at(places, told), rcond=None)[0]
    own = curve.site.effect.parameters
    inside = [*found.tolist(), *(told[p.name] for p in own[shape.count :])]
    start = {curve.site.key(p.name): max(x, p.lower) for p, x in zip(own, inside, strict=True)}
    return Begun(shape, site.where, {**values, **start}, fit.initials())
