"""A learned law in closed form: a sum of a few words of a small physical vocabulary, whose numbers a fit finds.

Its name holds which words stand in it and the range of the recordings that they were found in
("learned_law[formula|force|v|-0.3|0.3|up=11.0]"), with the size that each is fitted on.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, cast

import numpy as np

from spacerobot.effects.effect import Parameter
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.laws import spring_energy
from spacerobot.effects.learned import (
    PREFIX,
    Functions,
    Kind,
    Law,
    Nameless,
    Variable,
    against,
    argument,
    remembered_force,
    shared,
)
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.memory import Memory
from spacerobot.support.errors import InputError

FORM: Final = PREFIX + "formula|"

MOST_WORDS = 6
"""In one formula."""


@dataclass(frozen=True)
class Word:
    """One of the vocabulary.

    Attributes:
        code: by which compiled laws know it.
        latex, python: with {x} for the variable, and the names of its own further numbers.
        power: of the variable; of one that is fitted, nothing: the coefficient is its value at 1.
        further: names of numbers beside its coefficient, two at most, the last one positive.
    """

    code: int
    latex: str
    python: str
    power: int
    further: tuple[str, ...] = ()


WORDS: Final[Mapping[str, Word]] = {
    "one": Word(0, "", "1.0", 0),
    "line": Word(1, "{x}", "{x}", 1),
    "up": Word(2, r"\max({x}, 0)", "max({x}, 0.0)", 1),
    "down": Word(3, r"\min({x}, 0)", "min({x}, 0.0)", 1),
    "abs": Word(4, "|{x}|", "abs({x})", 1),
    "square": Word(5, "{x}^2", "{x} * {x}", 2),
    "odd": Word(6, "{x}|{x}|", "{x} * abs({x})", 2),
    "cube": Word(7, "{x}^3", "{x} * {x} * {x}", 3),
    "rise": Word(
        8,
        r"\exp\left(-\left(\frac{{{x} - {place}}}{{{width}}}\right)^2\right)",
        "math.exp(-((({x} - {place}) / {width}) ** 2))",
        0,
        ("place", "width"),
    ),
    "wave": Word(
        9,
        r"\cos\left(2 \pi \frac{{{x} - {place}}}{{{length}}}\right)",
        "math.cos(2.0 * math.pi * ({x} - {place}) / {length})",
        0,
        ("place", "length"),
    ),
    "power": Word(
        10,
        r"\operatorname{{sign}}({x})\,|{x}|^{{{exponent}}}",
        "math.copysign(abs({x}) ** {exponent}, {x})",
        0,
        ("exponent",),
    ),
}

_UNITS: Final[Mapping[Variable, tuple[str, str, str, str]]] = {
    "d": ("N", "N/m", "N/m^2", "N/m^3"),
    "v": ("N", "N s/m", "N s^2/m^2", "N s^3/m^3"),
    "N": ("N", "1", "1/N", "1/N^2"),
    "z": ("N/m", "1/m", "1/(N m)", "1/(N^2 m)"),
    "q": ("N", "N/m", "N/m^2", "N/m^3"),
}

OF_UNIT: Final[Mapping[Variable, str]] = {"d": "m", "v": "m/s", "N": "N", "z": "N", "q": "m"}
"""Of what a law depends on."""


def unit_of(word: str, of: Variable) -> str:
    """Unit of a word's coefficient in a law of this variable."""
    return _UNITS[of][WORDS[word].power]


def worth(code: float, x: float, place: float, width: float) -> float:
    """A word of the vocabulary at x."""
    if code == 0.0:
        return 1.0
    if code == 1.0:
        return x
    if code == 2.0:
        return max(x, 0.0)
    if code == 3.0:
        return min(x, 0.0)
    if code == 4.0:
        return abs(x)
    if code == 5.0:
        return x * x
    if code == 6.0:
        return x * abs(x)
    if code == 7.0:
        return x * x * x
    if code == 9.0:
        return math.cos(2.0 * math.pi * (x - place) / width)
    if code == 10.0:
        return math.copysign(abs(x) ** width, x)
    return math.exp(-(((x - place) / width) ** 2))


def said(x: float, p: Any, at: int) -> float:
    """The sum at x; p[at] is the number of words, then of each (code, coefficient, place, width)."""
    value = 0.0
    for k in range(int(p[at])):
        i = at + 1 + 4 * k
        value += p[i + 1] * worth(p[i], x, p[i + 2], p[i + 3])
    return value


def formula_curve(first: float, second: float, third: float, p: Any) -> float:
    """As `learned.curve`, of the sum; p = (which, sign, words, ...)."""
    return against(said(argument(p[0], first, second, third), p, 2), p[1])


def formula_in_contact(d: float, v: float, aux: float, p: Any) -> float:
    """As `learned.in_contact`, of the sum; p = (k, c, which, words, ...)."""
    return -(p[0] * d + p[1] * v + said(argument(p[2], d, v, 0.0), p, 3))


def formula_rate(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """As `learned.remembered_rate`, of the sum; p = (b, words, ...)."""
    return said(way * z, p, 1) * v - p[0] * z


def formula_in_plane(d: float, v: float, aux: float, p: Any) -> float:
    """As `learned.in_plane`, of the sum; p = (which, sign, words, ...)."""
    speed = math.hypot(v, aux)
    return -shared(said(speed, p, 2), v, speed)


CLOSED = Functions(
    formula_curve,
    Kernel(formula_in_contact, energy=spring_energy),
    Memory(formula_rate, remembered_force),
    formula_in_plane,
    formula_curve,
)


@dataclass(frozen=True)
class Formula(Law):
    """Which words stand in a law.

    Attributes:
        words: each with a typical size of its coefficient, SI.
    """

    words: tuple[tuple[str, float], ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        sizes = [size for _, size in self.words]
        if not (1 <= len(self.words) <= MOST_WORDS and all(w in WORDS for w, _ in self.words)):
            raise InputError("a learned law has words of no vocabulary", given=self.words, valid=", ".join(WORDS))
        if not (all(map(math.isfinite, sizes)) and min(sizes) > 0.0):
            raise InputError("a learned law has an impossible size", given=sizes)

    @property
    def name(self) -> str:
        """The effect's name, from which `spoken` makes the same formula."""
        words = [f"{w}={size!r}" for w, size in self.words]
        return FORM + "|".join([self.kind, self.of, repr(self.low), repr(self.high), *words]) + "]"

    def parameters(self) -> tuple[Parameter, ...]:
        """A coefficient for each word, and its further numbers."""
        made: list[Parameter] = []
        signed = self.kind != "friction"
        for k, (word, size) in enumerate(self.words, 1):
            far = 1e6 * size
            least = -far if signed or word == "wave" else 0.0
            made.append(Parameter(f"a_{k}", unit_of(word, self.of), 0.0, size, least, far, (size,)))
            made += [self._further(f"a_{k}_{name}", name) for name in WORDS[word].further]
        return tuple(made)

    def _further(self, key: str, name: str) -> Parameter:
        reach, unit = self.high - self.low, OF_UNIT[self.of]
        if name == "exponent":
            return Parameter(key, "1", 1.0, 0.05, 0.1, 6.0, (1.0,), shape=True)
        if name == "place":
            middle = 0.5 * (self.low + self.high)
            return Parameter(
                key, unit, middle, 0.05 * reach, self.low - reach, self.high + reach, (middle,), shape=True
            )
        least, most, start = 1e-4 * reach, 10.0 * reach, 0.1 * reach
        if name == "length":  # many waves lie side by side: a small step moves the last one far
            return Parameter(key, unit, start, 1e-3 * reach, least, most, (start,), shape=True)
        return Parameter(key, unit, start, 0.1, least, most, (start,), log=True, shape=True)

    def numbers(self, values: Mapping[str, float]) -> tuple[float, ...]:
        """As compiled laws read them: the number of words, then of each (code, coefficient, place, width)."""
        out = [float(len(self.words))]
        for k, (word, _) in enumerate(self.words, 1):
            further = [values[f"a_{k}_{name}"] for name in WORDS[word].further]
            place, width = (0.0, 1.0, *further)[-2:] if further else (0.0, 1.0)
            out += [float(WORDS[word].code), values[f"a_{k}"], place, width]
        return tuple(out)

    def at(self, x: np.ndarray, values: Mapping[str, float]) -> np.ndarray:
        """The law at many places, shape (T,)."""
        p = self.numbers(values)
        return np.array([said(one, p, 0) for one in x.tolist()])

    def written(self, values: Mapping[str, float], digits: int = 4) -> str:
        """The law with its numbers, in LaTeX."""
        parts = []
        for k, (word, _) in enumerate(self.words, 1):
            more = {n: f"{values[f'a_{k}_{n}']:.{digits}g}" for n in WORDS[word].further}
            latex = WORDS[word].latex.format(x=self.of, **more)
            parts.append(f"{values[f'a_{k}']:.{digits}g}" + (rf"\,{latex}" if latex else ""))
        return f"s({self.of}) = " + " + ".join(parts).replace("+ -", "- ").replace("- -", "+ ")


def spoken(name: str) -> Formula:
    """The formula that a name holds.

    Raises:
        InputError: the name is not one of a learned law in closed form.
    """
    words = name.removeprefix(FORM).removesuffix("]").split("|")
    try:
        kind, of, low, high, *rest = words
        numbers = float(low), float(high)
        pairs = tuple((w.split("=")[0], float(w.split("=")[1])) for w in rest)
    except (ValueError, IndexError):
        raise InputError("not a learned law", given=name, valid=f"{FORM}kind|of|low|high|word=size|...]") from None
    return Formula(cast(Kind, kind), cast(Variable, of), *numbers, pairs)


class FormulaLaw(Nameless[Formula]):
    """A sum of words whose numbers are fitted."""

    source = "learned from recordings"

    def __init__(self, formula: Formula) -> None:
        super().__init__(formula, formula.parameters())

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The law at the port."""
        law = self.shape
        size = max(abs(law.low), abs(law.high), 1e-6)
        numbers, fades = law.numbers(values), values.get("rate_1_s", 0.0)
        return CLOSED.acting(mechanism, where, law.kind, law.of, numbers, fades, size)


def evaluated(word: str, x: np.ndarray, place: float = 0.0, width: float = 1.0) -> np.ndarray:
    """A word at many places, shape (T,)."""
    code = float(WORDS[word].code)
    return np.array([worth(code, value, place, width) for value in x.tolist()])
