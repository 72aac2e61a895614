"""A learned law as verdict.json says it: where, on what it depends, formula, table with its band, what it is like."""

from __future__ import annotations

from msgspec import UNSET, UnsetType

from spacerobot.diagnosis.answer.law_file import law_file
from spacerobot.diagnosis.answer.record import Learned, Like, Table, Value
from spacerobot.diagnosis.answer.turning import turning_unit
from spacerobot.diagnosis.fitting.fitted import interval
from spacerobot.diagnosis.learning.bands import band
from spacerobot.diagnosis.learning.learnt import Learnt
from spacerobot.effects.formula import OF_UNIT, FormulaLaw

VARIABLES = {
    "d": "displacement",
    "v": "rate",
    "z": "force remembered",
    "N": "normal force",
    "q": "displacement within a period",
}


def learned_law(learnt: Learnt, inflation: float, *, turns: bool = False, part: str | UnsetType = UNSET) -> Learned:
    """The record of one learned law.

    Args:
        learnt: the law.
        inflation: of the noise, for intervals [1].
        turns: whether what moves at its port is an angle: N is N m there, and m is rad.
        part: of several joints, bodies or axes, at which it was learned.
    """
    curve, told, fit = learnt.curve, learnt.told, learnt.fit
    shape, seen = curve.shape, band(curve)
    site = learnt.site
    numbers = {}
    values: dict[str, float] = {}
    for p in site.effect.parameters:
        if told is not None or p.name == "rate_1_s":  # a curve's coefficients stand in the table
            value, ends = interval(fit, site.key(p.name), inflation)
            values[p.name] = value
            numbers[p.name] = Value(value=value, ci95=ends, unit=turning_unit(p.unit) if turns else p.unit)
    of_unit, unit = OF_UNIT[shape.of], "N/m" if shape.kind == "memory" else "N"
    return Learned(
        where=curve.site.where,
        kind=shape.kind,
        depends_on=[VARIABLES[shape.of]],
        formula=told.formula.written(values) if told else None,
        law=site.effect.formula,
        parameters=numbers,
        table=Table(
            variable=shape.of,
            unit=turning_unit(of_unit) if turns else of_unit,
            value_unit=turning_unit(unit) if turns else unit,
            x=seen.x.tolist(),
            law=seen.law.tolist(),
            total=seen.total.tolist(),
            low=seen.low.tolist(),
            high=seen.high.tolist(),
            total_with=list(seen.with_),
        ),
        like=Like(effect=told.like, words=told.words) if told else None,
        lead=learnt.lead,
        part=part,
    )


def draft_of(learnt: Learnt) -> str | None:
    """A learned law as a file of its own, where it has a formula."""
    site, values = learnt.site, learnt.fit.values()
    if not isinstance(site.effect, FormulaLaw):
        return None
    return law_file(site.effect, site.own(values), site.where)
