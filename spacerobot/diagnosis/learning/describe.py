"""A learned curve in a formula: the few terms of a small physical vocabulary that say as much as the spline."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.learning.curves import Curve
from spacerobot.diagnosis.learning.shaped import Term, bumps, shaped
from spacerobot.diagnosis.terms.decision import SMALL
from spacerobot.effects.formula import Formula, evaluated
from spacerobot.effects.learned import Kind, Shape, Variable
from spacerobot.effects.registry import all_effects

MOST_TERMS = 3
KNOWN = 1e-9
"""Share of the best known combination's information, below which readings say nothing of one."""

TRIFLE = 1e-6
"""Of a typical force."""

ONE_WAY = 0.1
"""Share of the far end of a range that its near end reaches where it was gone through one way alone."""

VOCABULARY: dict[Kind, tuple[str, ...]] = {
    "force": ("one", "line", "up", "down", "odd", "cube", "square"),
    "friction": ("one", "line", "abs", "square"),
    "memory": ("one", "up", "down", "square", "cube"),
}
"""Words of which a law of each kind is made, the plainer first; of forces and frictions a local rise besides."""


WIDER: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("power", ()),
    ("power", ("one",)),
    ("rise", ("one",)),
    ("wave", ()),
    ("wave", ("one",)),
)
"""Further formulas of machines without a wrist: a word with numbers of its own, and plain ones beside it."""


@dataclass(frozen=True)
class Described:
    """A formula for a curve.

    Attributes:
        formula: its words.
        values: of its parameters, SI.
        words: what it is like, in a sentence.
        like: effect of the catalogue, or "".
        price: what a further fitted number must earn in chi-squared [1].
        off: how far it is from the curve, its numbers paid for, in chi-squared [1].
    """

    formula: Formula
    values: dict[str, float]
    words: str
    like: str
    price: float
    off: float

    @property
    def numbers(self) -> int:
        """How many are fitted."""
        return len(self.values)


def describe(curve: Curve, wider: bool = False) -> list[Described]:
    """The best formula of one word, of two and of three, and the best local rise, each as near to the spline as it can.

    With `wider` also powers and waves, and these and a rise beside plain words. Near by the likelihood of the spline's
    coefficients with everything else (and what is believed of it) marginalised; no trial is simulated. A further number
    must earn its BIC, and be more than a small defect of the others.
    """
    shape = curve.shape
    own = shape.count
    precision = _inverse(curve.covariance())
    prior = np.asarray(curve.site.effect.precision)[:own, :own] / shape.size**2
    told, ways = np.linalg.eigh(0.5 * (precision - prior + (precision - prior).T))
    seen = told > KNOWN * told.max()  # elsewhere the prior alone speaks
    root = np.sqrt(told[seen])[:, None] * ways[:, seen].T
    sought = (ways[:, seen].T @ (precision @ curve.coefficients())) / np.sqrt(told[seen])
    x = shape.closely
    basis = root @ np.linalg.pinv(shape.rows(x))

    def column(term: Term) -> np.ndarray:
        return np.asarray(basis @ evaluated(term.word, x, term.place, term.width))

    def fitted(columns: list[np.ndarray]) -> tuple[float, np.ndarray]:
        design = np.column_stack(columns)
        found = np.linalg.lstsq(design, sought, rcond=1e-9)[0]
        return float(np.sum((sought - design @ found) ** 2)), found

    plain = {Term(w): column(Term(w)) for w in _vocabulary(shape, wider)}
    best = [
        min(itertools.combinations(plain, size), key=lambda terms: fitted([plain[t] for t in terms])[0])
        for size in range(1, min(MOST_TERMS, len(plain)) + 1)
    ]

    def beside(words: tuple[str, ...]) -> Callable[[Term], float]:
        others = [plain[Term(w)] for w in words]
        return lambda term: fitted([column(term), *others])[0]

    if shape.of != "q":
        best += [(bump,) for bump in bumps(shape, beside(()))]
    for word, words in WIDER if wider else ():
        if set(words) <= {t.word for t in plain}:
            found = bumps(shape, beside(words)) if word == "rise" else shaped(shape, word, beside(words))
            best += [(term, *map(Term, words)) for term in found]
    price = float(np.log(float(curve.fit.samples)) + SMALL * float(sought @ sought))
    return [_described(shape, terms, *fitted([column(t) for t in terms]), price) for terms in best]


def _inverse(covariance: np.ndarray) -> np.ndarray:
    """Of a covariance; where a fit knows combinations of coefficients exactly, without these."""
    try:
        return np.asarray(np.linalg.inv(covariance))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(covariance, hermitian=True))


def _vocabulary(shape: Shape, wider: bool) -> list[str]:
    """Of a law, without words that others say as well; of what repeats with its place, what repeats."""
    if shape.of == "q":
        return ["one"]
    one_way = wider and min(abs(shape.low), abs(shape.high)) < ONE_WAY * max(abs(shape.low), abs(shape.high))
    return [w for w in VOCABULARY[shape.kind] if not (one_way and w in ("up", "down", "square", "abs"))]


def _described(shape: Shape, terms: tuple[Term, ...], off: float, found: np.ndarray, price: float) -> Described:
    """Its coefficients as they were found; what they are fitted on, no smaller than a trifle of the curve's size."""
    least = TRIFLE * shape.size / max(abs(shape.low), abs(shape.high)) ** 3
    sizes = tuple((t.word, max(abs(float(c)), least)) for t, c in zip(terms, found, strict=True))
    of: Variable = "d" if shape.of == "q" else shape.of  # what repeats says so itself
    formula = Formula(shape.kind, of, shape.low, shape.high, sizes)
    values = {f"a_{k}": float(c) for k, c in enumerate(found, 1)}
    for k, t in enumerate(terms, 1):
        values |= t.numbers(f"a_{k}")
    first = terms[int(np.argmax(np.abs(found)))]
    said = "; ".join(likeness(shape.kind, shape.of, t.word) for t in terms)
    like = _like(_curve_of(shape.kind, shape.of, first.word))
    return Described(formula, values, said, like, price, off + price * len(values))


def _like(curve: str) -> str:
    """The first effect of the catalogue that has such a curve."""
    return next((e.name for e in all_effects().values() if curve and e.curve == curve), "")


def _curve_of(kind: Kind, of: Variable, word: str) -> str:
    """In the word of effects, the curve that a term is a relative of, or ""."""
    if word in ("one", "rise", "wave", "power"):
        return "a level of friction" if kind == "friction" and of != "N" else "a constant" if word == "one" else ""
    shapes = {"up": "a line", "down": "a line", "odd": "a square", "cube": "a cube"}
    return f"{shapes[word]} in {of}" if word in shapes and kind == "force" else ""


def likeness(kind: Kind, of: Variable, word: str) -> str:
    """What a term is like, in words that go on from "it is" or "its curve"."""
    if word in ("up", "down"):
        if kind == "force" and of == "v":
            return "like viscous damping, on one stroke only"
        return f"growing where {of} is {'positive' if word == 'up' else 'negative'}"
    if word == "line" and (kind, of) == ("friction", "N"):
        return "like dry friction in proportion to what presses in the contact"
    return {
        "one": "a constant",
        "line": "rising in a straight line",
        "abs": "growing either way",
        "square": "growing with the square, either way",
        "odd": "growing with the square",
        "cube": "growing with the cube",
        "rise": "a local rise, which fades away from its place",
        "wave": "a ripple, which repeats along the way",
        "power": "growing as a power of its own",
    }[word]
