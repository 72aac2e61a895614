"""A learned law: what acts at a port as a smooth curve whose numbers a fit finds, where no formula is known.

The curve is a cubic spline on equal cells over the range that recordings visited, held at its end value beyond. Its
coefficients c_k are a level and a slope at rest, and second differences ("bends") away from it:

    c = level + slope u + T bend,    bend ~ N(0, roughness^2),

in units of a typical force, u = -1..1 over the range. Bends have a normal prior, so the curve is as smooth as its
roughness says: an integrated random walk, whose posterior mean is the smoothing spline of Wahba (1978).

Its name holds all that is not fitted ("learned_law[level|d|0|0.02|24|0.1|1]"), so that it can be kept, sent and found
again like any other effect's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal, TypeAlias, cast, get_args

import numpy as np

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.kernel import PARAMETERS, Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force, Friction
from spacerobot.support.errors import InputError

PREFIX: Final = "learned_law["

Kind: TypeAlias = Literal["force", "friction"]
"""A force at the port, or dry friction of that level, with sticking."""

Variable: TypeAlias = Literal["d", "v"]
"""Displacement or rate of the port."""

HEADER = 5
MOST = PARAMETERS - HEADER
"""Coefficients of a curve, at most."""


def curve(first: float, second: float, third: float, p: Any) -> float:
    """The spline at one of three arguments; p = (which, sign, low, width of a cell, cells, c_0 ... c_(cells + 2)).

    With sign > 0 a level that is never negative.
    """
    x = first
    if p[0] == 1.0:
        x = second
    elif p[0] == 2.0:
        x = third
    cells = int(p[4])
    u = (x - p[2]) / p[3]
    u = min(max(u, 0.0), float(cells))
    k = min(int(u), cells - 1)
    t = u - k
    s = 1.0 - t
    value = (
        s * s * s * p[5 + k]
        + (3.0 * t * t * t - 6.0 * t * t + 4.0) * p[6 + k]
        + (3.0 * s * s * s - 6.0 * s * s + 4.0) * p[7 + k]
        + t * t * t * p[8 + k]
    ) / 6.0
    if p[1] > 0.0:
        return max(value, 0.0)
    return -value


@dataclass(frozen=True)
class Shape:
    """All of a learned law that is not fitted.

    Attributes:
        kind: what it is.
        of: what it depends on.
        low, high: range that the curve covers, SI.
        cells: of equal width.
        roughness: standard deviation of a bend, in units of `size`.
        size: typical force [N]; standard deviation of level and slope.
    """

    kind: Kind
    of: Variable
    low: float
    high: float
    cells: int
    roughness: float
    size: float

    def __post_init__(self) -> None:
        numbers = (self.low, self.high, self.roughness, self.size)
        if self.kind not in get_args(Kind) or self.of not in get_args(Variable):
            raise InputError("no such learned law", given=f"{self.kind} of {self.of}", valid="force, friction of d, v")
        if not (all(map(math.isfinite, numbers)) and self.low < self.high and self.roughness > 0.0 < self.size):
            raise InputError("a learned law has an impossible range, roughness or size", given=numbers)
        if not 2 <= self.cells <= MOST - 3:
            raise InputError("a learned law has too many cells, or too few", given=self.cells, valid=f"2 to {MOST - 3}")

    @property
    def name(self) -> str:
        """The effect's name, from which `parsed` makes the same shape."""
        numbers = (self.low, self.high, self.cells, self.roughness, self.size)
        return PREFIX + "|".join([self.kind, self.of, *(f"{x!r}" for x in numbers)]) + "]"

    @property
    def places(self) -> np.ndarray:
        """Where each coefficient has its say, shape (cells + 3,), SI."""
        width = (self.high - self.low) / self.cells
        return self.low + width * np.arange(-1.0, self.cells + 2.0)

    def transform(self) -> np.ndarray:
        """Coefficients per parameter (level, slope, bends), shape (cells + 3, cells + 3) [N].

        Bends count from the coefficient nearest to rest outwards, so that level and slope are those at rest.
        """
        x = self.places
        rest = int(np.argmin(np.abs(x)))
        count = x.size
        out = np.zeros((count, count))
        out[:, 0] = 1.0
        out[:, 1] = (x - x[rest]) / np.abs(x - x[rest]).max()
        column = 2
        for way in (1, -1):
            reach = count - 1 - rest if way > 0 else rest
            for start in range(1, reach):  # a bend at `start` turns all that lies beyond it
                beyond = np.arange(start + 1, reach + 1)
                out[rest + way * beyond, column] = self.roughness * (beyond - start)
                column += 1
        if column < count:  # the bend at rest itself, where there is something on either side
            out[:, column] = self.roughness * 0.5 * np.abs(np.arange(count) - rest)
        return self.size * out

    def coefficients(self, parameters: Sequence[float]) -> np.ndarray:
        """Coefficients of the spline, shape (cells + 3,) [N]."""
        return self.transform() @ np.asarray(parameters, dtype=float)

    def rows(self, x: np.ndarray) -> np.ndarray:
        """Of the curve at x, shape (T,): its value per coefficient, shape (T, cells + 3)."""
        u = np.clip((x - self.low) / (self.high - self.low) * self.cells, 0.0, self.cells)
        k = np.minimum(u.astype(int), self.cells - 1)
        t = u - k
        s = 1.0 - t
        parts = (s**3, 3 * t**3 - 6 * t**2 + 4, 3 * s**3 - 6 * s**2 + 4, t**3)
        out = np.zeros((x.size, self.cells + 3))
        for j, part in enumerate(parts):
            out[np.arange(x.size), k + j] = part / 6.0
        return out

    def rougher(self, factor: float) -> Shape:
        """The same with bends that may be so many times as large."""
        return replace(self, roughness=self.roughness * factor)


def parsed(name: str) -> Shape:
    """The shape that a name holds.

    Raises:
        InputError: the name is not one of a learned law.
    """
    words = name.removeprefix(PREFIX).removesuffix("]").split("|")
    try:
        kind, of, low, high, cells, roughness, size = words
        numbers = float(low), float(high), int(cells), float(roughness), float(size)
    except ValueError:
        raise InputError("not a learned law", given=name, valid=f"{PREFIX}kind|of|low|high|cells|roughness|size]") from None
    return Shape(cast(Kind, kind), cast(Variable, of), *numbers)


class LearnedLaw(Effect):
    """A curve whose numbers are fitted."""

    title = "learned law"
    phrase = "a law of no name"
    source = "smoothing spline; Wahba (1978)"
    learned = True

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        given = {
            "name": shape.name,
            "formula": rf"f = -s({shape.of})" if shape.kind == "force" else rf"|f| \le s({shape.of})",
            "parameters": tuple(_parameter(k) for k in range(shape.cells + 3)),
        }
        for key, value in given.items():
            setattr(self, key, value)  # an instance is an effect of its own, as a class of the catalogue is

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Wherever something moves along a line."""
        return tuple(p for p in mechanism.ports if p != "contact")

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The curve at the port."""
        shape = self.shape
        friction = shape.kind == "friction"
        which = {"d": 2.0, "v": 0.0}[shape.of] if friction else {"d": 0.0, "v": 1.0}[shape.of]
        width = (shape.high - shape.low) / shape.cells
        inside = shape.coefficients([values[p.name] for p in self.parameters])
        p = (which, 1.0 if friction else -1.0, shape.low, width, float(shape.cells), *inside.tolist())
        line = f"learned law at {where}"
        if friction:
            return mechanism.with_friction(Friction(line, where, curve, p))
        return mechanism.with_force(Force(line, where, Kernel(curve), p))


def _parameter(number: int) -> Parameter:
    name = ("level", "slope")[number] if number < 2 else f"bend_{number - 1:02d}"
    return Parameter(name, "", 0.0, 1.0, -1e4, 1e4, (0.0,), spread=True)
