"""A learned law: what acts at a port as a smooth curve whose numbers a fit finds, where no formula is known.

The curve is a cubic spline on equal cells over the range that recordings visited, held at its end value beyond. Second
differences of its coefficients ("bends") are normally distributed with a standard deviation of `roughness` typical
forces: the P-spline of Eilers and Marx (1996). A level of friction is never negative.

Its name holds all that is not fitted ("learned_law[level|d|0|0.02|24|0.1|1]"), so that it can be kept, sent and found
again like any other effect's.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, Generic, Literal, TypeAlias, TypeVar, cast

import numpy as np

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.kernel import PARAMETERS, Kernel, ScalarLaw
from spacerobot.effects.laws import spring_energy
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.memory import Memory
from spacerobot.effects.plane import across, along_all
from spacerobot.effects.primitives import Force, Friction, State
from spacerobot.support.errors import InputError

PREFIX: Final = "learned_law["

Kind: TypeAlias = Literal["force", "friction", "memory"]
"""A force at the port; dry friction of that level, with sticking; or a force that remembers: f = -z with
z' = s(z sign v) v - b z.
"""

Variable: TypeAlias = Literal["d", "v", "z", "N", "q"]
"""Displacement or rate of the port, what is remembered, the normal force that presses in the contact; or displacement
again, of which only the place within a period counts: a ripple of teeth, poles or a screw.
"""

OF: Final[Mapping[Kind, tuple[Variable, ...]]] = {
    "force": ("d", "v", "q"),
    "friction": ("d", "v", "N"),
    "memory": ("z",),
}
"""What each kind may depend on."""

HEADER = 6
MOST = PARAMETERS - HEADER
"""Coefficients of a curve, at most."""

CREEP = 1e-4
"""Speed [m/s] below which a force against the velocity of a body in the plane has no direction yet."""

ROOTED = 1e-3
"""Typical forces that a curve of a contact's depth has where there is none, as one standard deviation."""

ABSURD = 10.0
"""Typical forces that a coefficient is not beyond, as one standard deviation: what no reading visits stays finite."""


def spline(x: float, low: float, width: float, cells: int, p: Any, at: int) -> float:
    """The spline at x, held beyond its ends; its coefficients are p[at] ... p[at + cells + 2]."""
    u = min(max((x - low) / width, 0.0), float(cells))
    k = min(int(u), cells - 1)
    t = u - k
    s = 1.0 - t
    return (
        s * s * s * p[at + k]
        + (3.0 * t * t * t - 6.0 * t * t + 4.0) * p[at + k + 1]
        + (3.0 * s * s * s - 6.0 * s * s + 4.0) * p[at + k + 2]
        + t * t * t * p[at + k + 3]
    ) / 6.0


def argument(which: float, first: float, second: float, third: float) -> float:
    """The argument that a law depends on, counted from 0."""
    if which == 1.0:
        return second
    return third if which == 2.0 else first


def against(value: float, sign: float) -> float:
    """A force against what makes it; with sign > 0 a level of friction, which is never negative."""
    return max(value, 0.0) if sign > 0.0 else -value


def around(x: float, low: float, period: float) -> float:
    """x within the period that begins at `low`."""
    return x - period * math.floor((x - low) / period)


def ripple(d: float, v: float, aux: float, p: Any) -> float:
    """A force against the displacement, as `curve`, of which a period is p[3] p[4] long."""
    return -spline(around(d, p[2], p[3] * p[4]), p[2], p[3], int(p[4]), p, 5)


def shared(force: float, v: float, speed: float) -> float:
    """One component of a force against the velocity, whose own is v of `speed`."""
    return force * v / math.hypot(speed, CREEP)


def in_plane(d: float, v: float, aux: float, p: Any) -> float:
    """One component of a force against a body's velocity, of its speed, as `curve`; aux is the speed across."""
    speed = math.hypot(v, aux)
    return -shared(spline(speed, p[2], p[3], int(p[4]), p, 5), v, speed)


def curve(first: float, second: float, third: float, p: Any) -> float:
    """The spline at one of three arguments; p = (which, sign, low, width of a cell, cells, c_0 ... c_(cells + 2))."""
    return against(spline(argument(p[0], first, second, third), p[2], p[3], int(p[4]), p, 5), p[1])


def in_contact(d: float, v: float, aux: float, p: Any) -> float:
    """-(k d + c v + s), s of d or v as in `curve`; p = (k, c, which, low, width of a cell, cells, c_0 ...)."""
    return -(p[0] * d + p[1] * v + spline(argument(p[2], d, v, 0.0), p[3], p[4], int(p[5]), p, 6))


def remembered_rate(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """z' = s(z sign v) v - b z; p = (b, low, width of a cell, cells, c_0 ... c_(cells + 2)), s as in `curve`."""
    return spline(way * z, p[1], p[2], int(p[3]), p, 4) * v - p[0] * z


def remembered_force(z: float, rate: float, d: float, v: float, way: float, normal: float, p: Any) -> float:
    """-z."""
    return -z


@dataclass(frozen=True)
class Functions:
    """A function of one variable as backends need it; `numbers` are those that say which function it is.

    Attributes:
        curve: of (first, second, third); p = (which of them, sign, *numbers).
        in_contact: the contact law with it; p = (k, c, which, *numbers).
        memory: where it is the stiffness of what remembers; p = (b, *numbers).
        in_plane: of the speed of a body that moves in several directions, against its velocity; p as of `curve`.
        ripple: of the place within a period, p as of `curve`; the curve itself where that repeats by itself.
    """

    curve: ScalarLaw
    in_contact: Kernel
    memory: Memory
    in_plane: ScalarLaw
    ripple: ScalarLaw

    def acting(
        self,
        mechanism: Mechanism,
        where: str,
        kind: Kind,
        of: Variable,
        numbers: tuple[float, ...],
        forgetting: float = 0.0,
        size: float = 1.0,
    ) -> Mechanism:
        """The mechanism in which the function acts at a port.

        Args:
            mechanism: to be edited.
            where: the port.
            kind, of: what the function is, and of what.
            numbers: that say which function it is.
            forgetting: b of what remembers [1/s].
            size: of what is remembered, typically [N].
        """
        line = f"learned law at {where}"
        if kind == "memory":
            return mechanism.with_state(State(line, where, self.memory, (forgetting, *numbers), size))
        if kind == "friction":
            pressed = "contact" if of == "N" else None
            p = ({"d": 2.0, "v": 0.0, "N": 1.0}[of], 1.0, *numbers)
            return mechanism.with_friction(Friction(line, where, self.curve, p, normal=pressed))
        which = {"d": 0.0, "v": 1.0, "q": 0.0}[of]
        if where == "contact":
            law = self.in_contact
            return mechanism.with_contact(lambda c: replace(c, kernel=law, p=(*c.p[:2], which, *numbers)))
        p = (which, -1.0, *numbers)
        if of == "v" and (others := across(mechanism, where)):
            return mechanism.with_force(*along_all(line, (where, *others), Kernel(self.in_plane), p))
        return mechanism.with_force(Force(line, where, Kernel(self.ripple if of == "q" else self.curve), p))


SPLINE = Functions(
    curve, Kernel(in_contact, energy=spring_energy), Memory(remembered_rate, remembered_force), in_plane, ripple
)


def ports_for(kind: Kind, mechanism: Mechanism) -> tuple[str, ...]:
    """Wherever something moves along a line; in the contact as a force, where that has the spring-dashpot law."""
    there = [p for p in mechanism.ports if p != "contact"]
    linear = mechanism.contact is not None and mechanism.contact.p[2:] == (1.0, 0.0)
    return (*there, *(["contact"] if linear and kind == "force" else ()))


@dataclass(frozen=True)
class Law:
    """What a learned law is, and where it is known.

    Attributes:
        kind: what it is.
        of: what it depends on.
        low, high: range of that, which recordings visited, SI.
    """

    kind: Kind
    of: Variable
    low: float
    high: float

    def __post_init__(self) -> None:
        if self.of not in OF.get(self.kind, ()):
            raise InputError("no such learned law", given=f"{self.kind} of {self.of}", valid=str(OF))
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise InputError("a learned law has an impossible range", given=(self.low, self.high))

    @property
    @abstractmethod
    def name(self) -> str:
        """The effect's name, which holds all that is not fitted."""


@dataclass(frozen=True)
class Shape(Law):
    """All of a learned curve that is not fitted.

    Attributes:
        cells: of equal width.
        roughness: standard deviation of a bend, in units of `size`.
        size: typical force [N]; of what remembers, typical stiffness [N/m].
    """

    cells: int
    roughness: float
    size: float

    def __post_init__(self) -> None:
        super().__post_init__()
        numbers = (self.roughness, self.size)
        if not (all(map(math.isfinite, numbers)) and min(numbers) > 0.0):
            raise InputError("a learned law has an impossible roughness or size", given=numbers)
        if not 2 <= self.cells <= MOST - 3:
            raise InputError("a learned law has too many cells, or too few", given=self.cells, valid=f"2 to {MOST - 3}")

    @property
    def name(self) -> str:
        """The effect's name, from which `parsed` makes the same shape."""
        numbers = (self.low, self.high, self.cells, self.roughness, self.size)
        return PREFIX + "|".join([self.kind, self.of, *(f"{x!r}" for x in numbers)]) + "]"

    @property
    def count(self) -> int:
        """How many coefficients there are, K; those of a ripple go round."""
        return self.cells + (0 if self.of == "q" else 3)

    @property
    def places(self) -> np.ndarray:
        """Where each coefficient has its say, shape (K,), SI."""
        width = (self.high - self.low) / self.cells
        return self.low + width * np.arange(-1.0, self.count - 1.0)

    @property
    def closely(self) -> np.ndarray:
        """Places over the whole range, eight for each coefficient, at which another law is laid beside it, SI."""
        return np.linspace(self.low, self.high, 8 * self.count)

    def bends(self) -> np.ndarray:
        """Second differences of the coefficients, shape (B, K)."""
        if self.of == "q":
            unit = np.eye(self.cells)
            return np.asarray(np.roll(unit, 1, axis=0) - 2.0 * unit + np.roll(unit, -1, axis=0))
        return np.asarray(np.diff(np.eye(self.count), 2, axis=0))

    @property
    def rooted(self) -> bool:
        """Whether its range begins where nothing is displaced, as the depth of a contact does: no force acts there."""
        return self.kind == "force" and self.of == "d" and self.low == 0.0

    def precision(self) -> np.ndarray:
        """Of the parameters in units of `size`, shape (P, P): bends, a size that is not absurd, where it is rooted."""
        bends = self.bends()
        own = self.count
        out = np.eye(own + (self.kind == "memory")) / ABSURD**2
        out[:own, :own] += bends.T @ bends / self.roughness**2
        if self.rooted:
            root = self.rows(np.zeros(1))
            out[:own, :own] += root.T @ root / ROOTED**2
        return out

    def rows(self, x: np.ndarray) -> np.ndarray:
        """Of the curve at x, shape (T,): its value per coefficient, shape (T, K)."""
        if self.of == "q":
            x = self.low + np.mod(x - self.low, self.high - self.low)
        u = np.clip((x - self.low) / (self.high - self.low) * self.cells, 0.0, self.cells)
        k = np.minimum(u.astype(int), self.cells - 1)
        t = u - k
        s = 1.0 - t
        parts = (s**3, 3 * t**3 - 6 * t**2 + 4, 3 * s**3 - 6 * s**2 + 4, t**3)
        out = np.zeros((x.size, self.count))
        for j, part in enumerate(parts):
            out[np.arange(x.size), (k + j) % self.count] += part / 6.0
        return out

    def rougher(self, factor: float) -> Shape:
        """The same with bends that may be so many times as large."""
        return replace(self, roughness=self.roughness * factor)

    def over(self, low: float, high: float) -> Shape:
        """The same over another range, as rough: see `divided`."""
        wider = (high - low) / (self.high - self.low)
        return replace(self, low=low, high=high, roughness=self.roughness * wider**1.5)

    def divided(self, cells: int) -> Shape:
        """The same into so many cells, as rough: over a step h a random walk's rate bends a curve by h^(3/2)."""
        return replace(self, cells=cells, roughness=self.roughness * (self.cells / cells) ** 1.5)


FORMULAS: Final[Mapping[Kind, str]] = {
    "force": "f = -s({})",
    "friction": r"|f| \le s({})",
    "memory": r"f = -z, \quad \dot z = s(z \operatorname{{sign}} v)\, v - b z",
}


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
        raise InputError(
            "not a learned law", given=name, valid=f"{PREFIX}kind|of|low|high|cells|roughness|size]"
        ) from None
    return Shape(cast(Kind, kind), cast(Variable, of), *numbers)


L = TypeVar("L", bound=Law)


class Nameless(Effect, Generic[L]):
    """An effect that is a learned law, in whatever form."""

    title = "learned law"
    phrase = "a law of no name"
    learned = True

    def __init__(self, shape: L, parameters: tuple[Parameter, ...]) -> None:
        self.shape = shape
        given = {
            "name": shape.name,
            "formula": FORMULAS[shape.kind].format(shape.of),
            "parameters": (*parameters, *forgets(shape.kind)),
        }
        for key, value in given.items():
            setattr(self, key, value)  # an instance is an effect of its own, as a class of the catalogue is

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """As `ports_for`."""
        return ports_for(self.shape.kind, mechanism)


class LearnedLaw(Nameless[Shape]):
    """A curve whose numbers are fitted."""

    source = "P-spline; Eilers and Marx (1996)"

    def __init__(self, shape: Shape) -> None:
        super().__init__(shape, tuple(_parameter(k, shape) for k in range(shape.count)))

    @property
    def precision(self) -> np.ndarray:
        """How smooth the curve is believed to be."""
        return self.shape.precision()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The curve at the port."""
        shape = self.shape
        inside = [values[p.name] for p in self.parameters]
        forgetting = inside.pop() if shape.kind == "memory" else 0.0
        if shape.of == "q":
            inside += inside[:3]
        numbers = (shape.low, (shape.high - shape.low) / shape.cells, float(shape.cells), *inside)
        size = max(shape.high, 1e-6)
        return SPLINE.acting(mechanism, where, shape.kind, shape.of, numbers, forgetting, size)


def forgets(kind: Kind) -> tuple[Parameter, ...]:
    """The rate at which what is remembered fades; nothing of other kinds."""
    return (Parameter("rate_1_s", "1/s", 0.0, 5.0, 0.0, 1e4, (0.0,)),) if kind == "memory" else ()


def _parameter(number: int, shape: Shape) -> Parameter:
    lower = 0.0 if shape.kind == "friction" else -1e6 * shape.size
    return Parameter(f"c_{number:02d}", "", 0.0, shape.size, lower, 1e6 * shape.size, (0.0,))
