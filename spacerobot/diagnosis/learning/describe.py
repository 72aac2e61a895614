"""A learned curve in a formula: the few terms of a small physical vocabulary that say as much as the spline."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.learning.curves import Curve
from spacerobot.diagnosis.selection.penalty import SMALL
from spacerobot.effects.registry import all_effects

MOST_TERMS = 3
BUMPS = 24
"""Places, and half as many widths, at which a local rise is tried before it is moved to its best."""


@dataclass(frozen=True, eq=False)
class Term:
    """One word of the vocabulary.

    Attributes:
        formula: with {} for its coefficient.
        words: what it is like.
        curve: in the word of effects that it is a relative of, or "".
        shape: value at x, shape (T,) each.
        unit: of the coefficient.
        numbers: its own further numbers by name, SI.
    """

    formula: str
    words: str
    curve: str
    shape: Callable[[np.ndarray], np.ndarray]
    unit: str
    numbers: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Described:
    """A formula for a curve.

    Attributes:
        formula: LaTeX.
        words: what it is like, in a sentence.
        like: effect of the catalogue, or "".
        parameters: name -> (value, one standard error, unit).
        misfit: chi-squared over the spline's [1]; what is left of the curve is noise where it is no larger than `room`.
        room: number of the spline's coefficients that the data determine.
    """

    formula: str
    words: str
    like: str
    parameters: dict[str, tuple[float, float, str]]
    misfit: float
    room: float


def describe(curve: Curve) -> Described | None:
    """The plainest formula that says as much as the spline; None where none of the vocabulary does.

    Terms are chosen by BIC, from the likelihood of the spline's coefficients with everything else (and what is believed
    of it) marginalised; no trial is simulated. A further term must also be more than a small defect of the others.
    """
    shape = curve.shape
    own = shape.cells + 3
    precision = np.linalg.inv(curve.covariance())
    prior = np.asarray(curve.site.effect.precision)[:own, :own] / shape.size**2
    data = precision - prior
    data = 0.5 * (data + data.T)
    pull = precision @ curve.coefficients()
    x = np.linspace(shape.low, shape.high, 8 * own)
    basis = np.linalg.pinv(shape.rows(x))
    least = float(pull @ np.linalg.pinv(data, rcond=1e-9, hermitian=True) @ pull)
    room = float(np.trace(np.linalg.solve(precision, data)))
    samples = float(curve.fit.samples)

    def fitted(terms: tuple[Term, ...]) -> tuple[float, np.ndarray, np.ndarray]:
        design = np.column_stack([basis @ t.shape(x) for t in terms])
        inside = design.T @ data @ design
        covariance = np.linalg.pinv(inside, rcond=1e-12, hermitian=True)
        found = covariance @ (design.T @ pull)
        return least - float(found @ design.T @ pull), found, covariance

    earn = np.log(samples) + SMALL * max(least, 0.0)
    words = _words(shape.kind, shape.of)
    best: tuple[float, tuple[Term, ...]] | None = None
    for size in range(1, MOST_TERMS + 1):
        for terms in itertools.combinations(words, size):
            misfit = fitted(terms)[0]
            price = misfit + size * earn
            if best is None or price < best[0]:
                best = price, terms
    for bump in _bumps(shape.kind, shape.of, shape.low, shape.high, lambda t: fitted((t,))[0]):
        price = fitted((bump,))[0] + 3 * earn
        if best is None or price < best[0]:
            best = price, (bump,)
    assert best is not None  # the vocabulary has words for every kind
    misfit, found, covariance = fitted(best[1])
    if misfit > room + 4.0 * np.sqrt(2.0 * room) + 2.0 * earn:
        return None
    parameters: dict[str, tuple[float, float, str]] = {}
    parts = []
    for k, term in enumerate(best[1]):
        name = f"a_{k + 1}"
        parameters[name] = (float(found[k]), float(np.sqrt(covariance[k, k])), term.unit)
        parameters |= {f"{name}_{n}": (v, float("nan"), "m") for n, v in term.numbers}
        parts.append(term.formula.format(f"{found[k]:.4g}"))
    law = " + ".join(parts).replace("+ -", "- ")
    first = best[1][int(np.argmax([abs(x) for x in found]))]
    return Described(law, "; ".join(t.words for t in best[1]), _like(first.curve), parameters, misfit, room)


def _like(curve: str) -> str:
    """The first effect of the catalogue that has such a curve."""
    return next((e.name for e in all_effects().values() if curve and e.curve == curve), "")


def _words(kind: str, of: str) -> tuple[Term, ...]:
    per = {"v": "s/m", "d": "/m", "z": "/N"}[of]
    unit = "N/m" if kind == "memory" else "N"
    first = "N s/m" if of == "v" else unit + per
    one = Term("{}", "a constant", "a level of friction" if kind == "friction" else "a constant", np.ones_like, unit)
    rise = Term(rf"{{}}\,\max({of}, 0)", _way(kind, of, 1), f"a line in {of}", lambda x: np.maximum(x, 0.0), first)
    fall = Term(rf"{{}}\,\min({of}, 0)", _way(kind, of, -1), f"a line in {of}", lambda x: np.minimum(x, 0.0), first)
    odd = Term(rf"{{}}\,{of}|{of}|", "growing with the square", f"a square in {of}", lambda x: x * np.abs(x), unit)
    cube = Term(rf"{{}}\,{of}^3", "growing with the cube", f"a cube in {of}", lambda x: x**3, unit)
    even = Term(rf"{{}}\,|{of}|", "growing either way", "", np.abs, first)
    square = Term(rf"{{}}\,{of}^2", "growing with the square, either way", "", np.square, unit)
    straight = Term(f"{{}} {of}", "rising in a straight line", "", lambda x: x, first)
    if kind == "force":
        return (one, straight, rise, fall, odd, cube, square)
    if kind == "friction":
        return (one, straight, even, square)
    return (one, rise, fall, square, cube)


def _way(kind: str, of: str, sign: int) -> str:
    side = "positive" if sign > 0 else "negative"
    if kind == "force" and of == "v":
        return "like viscous damping, on one stroke only"
    return f"growing where {of} is {side}"


def _bumps(kind: str, of: str, low: float, high: float, cost: Callable[[Term], float]) -> Iterator[Term]:
    """The best local rise there is."""
    if kind == "memory":
        return
    from scipy.optimize import minimize

    places = np.linspace(low, high, BUMPS)
    widths = np.geomspace(0.03, 0.5, BUMPS // 2) * (high - low)
    start = min(((p, w) for p in places for w in widths), key=lambda at: cost(_bump(kind, of, *at)))
    scale = 0.05 * (high - low)

    def moved(step: np.ndarray) -> Term:
        return _bump(kind, of, float(start[0] + scale * step[0]), float(start[1] * np.exp(step[1])))

    def price(step: np.ndarray) -> float:
        return cost(moved(step))

    yield moved(minimize(price, np.zeros(2), method="Nelder-Mead").x)


def _bump(kind: str, of: str, place: float, width: float) -> Term:
    unit = {"d": "m", "v": "m/s"}[of]
    formula = rf"{{}}\,\exp\left(-\left(\frac{{{{{of} - {place:.4g}}}}}{{{{{width:.3g}}}}}\right)^2\right)"
    return Term(
        formula,
        f"rises and falls: most at {place:.4g} {unit}",
        "a level of friction" if kind == "friction" else "",
        lambda x: np.exp(-(((x - place) / width) ** 2)),
        "N",
        (("place", place), ("width", width)),
    )
