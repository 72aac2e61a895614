"""A learned law as verdict.json says it: where, on what it depends, formula, table with its band, what it is like."""

from __future__ import annotations

from spacerobot.diagnosis.answer.record import Learned, Like, Table, Value
from spacerobot.diagnosis.fitting.fitted import interval
from spacerobot.diagnosis.learning.bands import band
from spacerobot.diagnosis.learning.learn import Learnt
from spacerobot.effects.formula import OF_UNIT

VARIABLES = {"d": "displacement", "v": "rate", "z": "force remembered", "N": "normal force"}


def learned_law(learnt: Learnt, inflation: float) -> Learned:
    """The record of one learned law; intervals with the noise's inflation [1]."""
    curve, told, fit = learnt.curve, learnt.told, learnt.fit
    shape, seen = curve.shape, band(curve)
    site = learnt.site
    numbers = {}
    values: dict[str, float] = {}
    for p in site.effect.parameters:
        if told is not None or p.name == "rate_1_s":  # a curve's coefficients stand in the table
            value, ends = interval(fit, site.key(p.name), inflation)
            values[p.name] = value
            numbers[p.name] = Value(value=value, ci95=ends, unit=p.unit)
    return Learned(
        where=curve.site.where,
        kind=shape.kind,
        depends_on=[VARIABLES[shape.of]],
        formula=told.formula.written(values) if told else None,
        law=site.effect.formula,
        parameters=numbers,
        table=Table(
            variable=shape.of,
            unit=OF_UNIT[shape.of],
            value_unit="N/m" if shape.kind == "memory" else "N",
            x=seen.x.tolist(),
            law=seen.law.tolist(),
            total=seen.total.tolist(),
            low=seen.low.tolist(),
            high=seen.high.tolist(),
            total_with=list(seen.with_),
        ),
        like=Like(effect=told.like, words=told.words) if told else None,
        lead=learnt.lead,
    )
