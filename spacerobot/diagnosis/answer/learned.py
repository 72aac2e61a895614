"""A learned law as verdict.json says it: where, on what it depends, formula, table with its band, what it is like."""

from __future__ import annotations

from spacerobot.diagnosis.answer.record import Learned, Like, Table, Value
from spacerobot.diagnosis.fitting.fitted import NORMAL_95
from spacerobot.diagnosis.learning.bands import band
from spacerobot.diagnosis.learning.describe import describe
from spacerobot.diagnosis.learning.learn import Learnt

VARIABLES = {"d": ("displacement", "m"), "v": ("rate", "m/s"), "z": ("force remembered", "N")}


def learned_law(learnt: Learnt) -> Learned:
    """The record of one learned law."""
    curve, told = learnt.curve, describe(learnt.curve)
    shape, seen = curve.shape, band(curve)
    said, unit = VARIABLES[shape.of]
    values = curve.fit.values()
    numbers = {
        p.name: Value(value=values[curve.site.key(p.name)], ci95=None, unit="1/s")
        for p in curve.site.effect.parameters[shape.cells + 3 :]
    }
    for name, (value, error, of) in (told.parameters if told else {}).items():
        known = error == error  # a place or a width has no error of its own
        ends = (value - NORMAL_95 * error, value + NORMAL_95 * error) if known else None
        numbers[name] = Value(value=value, ci95=ends, unit=of)
    return Learned(
        where=curve.site.where,
        kind=shape.kind,
        depends_on=[said],
        formula=f"s({shape.of}) = {told.formula}" if told else None,
        law=curve.site.effect.formula,
        parameters=numbers,
        table=Table(
            variable=shape.of,
            unit=unit,
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
