"""The contract of an effect: one piece of physics that a model has or lacks."""

from __future__ import annotations

import copy
import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import ClassVar, Final, Literal, Self

import numpy as np

from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.sizes import Sizes
from spacerobot.support.errors import InputError, NotFoundError

FORM: Final = "~"
"""What stands between the name of an effect and the form that it is in."""

Together = Literal["", "point", "whole", "field", "zero"]
"""As what all parts of a machine feel an effect, see `Effect.together`; empty of one that each has for itself."""


def said_name(name: str) -> str:
    """The name that a verdict gives an effect: a learned law's shape or a form is no part of it."""
    return name.split("[")[0].split(FORM)[0]


@dataclass(frozen=True)
class Parameter:
    """One number of an effect.

    Attributes:
        name: with its unit as suffix, e.g. "force_N".
        unit: for reports.
        null: value at which the edited mechanism is the baseline.
        scale: a typical size; what a fit takes for one step.
        lower, upper: physical bounds.
        starts: values from which fits begin, physical sizes of small to large.
        log: fitted on a logarithmic scale (positive numbers that may be wrong by factors).
        shape: says how the effect acts, not how strongly; it means nothing while the strength is null.
        reach: a displacement that its place hardly exceeds, so that fits also begin at the largest one recorded.
        moment: a time within a trial, so that fits also begin at times all over it.
    """

    name: str
    unit: str
    null: float
    scale: float
    lower: float
    upper: float
    starts: tuple[float, ...]
    log: bool = False
    shape: bool = False
    reach: bool = False
    moment: bool = False

    def __post_init__(self) -> None:
        if not self.lower <= self.upper or not self.scale > 0.0 or not self.starts:
            raise InputError("parameter has impossible bounds, scale or starts", given=self.name)

    def check(self, value: float, where: str = "") -> float:
        """`value` if it lies within the bounds.

        Raises:
            InputError: not finite (unless that is the null value), or outside.
        """
        if math.isnan(value) or not self.lower <= value <= self.upper:
            raise InputError(
                f"{self.name} is outside its bounds",
                given=value,
                valid=f"{self.lower:g} to {self.upper:g}" + (f" {self.unit}" if self.unit != "1" else ""),
                where=where or None,
            )
        return float(value)


class Effect(ABC):
    """Base of every effect. An implementer gives the class attributes and two methods.

    Class attributes:
        name: as verdicts and scenes name it.
        title: a few words for people.
        formula: LaTeX, printed by reports.
        source: where the formula comes from.
        parameters: its numbers.
        replaces: baseline constants whose job was to absorb it, with {where} for the place: refitted freely.
        removes: baseline constants that its own law makes meaningless: whatever they are, `edit` leaves nothing of
            them, and what is null is measured against a baseline without them.
        kind: "force", "body", "gravity", "contact" or "sensor", for grouping in reports.
        stands_for: what its law is the simplest form of, where that has more to it; what it leaves may be its own.
        phrase: the title as the object of a sentence, "a time offset"; the title itself if empty.
        refines: effects that it equals at some of its values: richer laws of the same thing, one of which a place has.
        limits: of a law that equals what it refines only as its shapes go to infinity or nothing, values at which it
            is as good as there; elsewhere it does so at any.
        same_as: last words of values of its place that act exactly as it does: "mass" of the wrist is wrist.mass,
            "clock" of a sensor its own clock's offset. No data tell the two apart, so where the value is fitted it
            stands for both.
        carried: acts on a floating body only where something carries or moors it, not on one that falls.
        relative: of a sensor; only the difference between two sensors shows, counted as positive at one of them.
        instant: shows in what is read just before and just after an impact, which has no duration.
        forms: of a law that comes in discrete forms, their names; the effect itself is the plainest of them.
        settings: of an effect in such a form, what it is called by: order, kind.
        choices: of an effect in such a form, among how many it was chosen, the plain one counted.
        together: of a machine in parts (the joints of an arm), every part feels it by one and the same shape: that is
            found by all of them together, before each is asked how much of it there is. As what they feel it: "point",
            a body at a place of a link; "whole", more of a link itself; "field", a pull on all of them along one
            direction; "zero", an encoder's.
        learned: a curve found in recordings, which has no name.
        curve: of a law of one variable, its shape in a word that a learned curve's description shares; empty elsewhere.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    formula: ClassVar[str]
    source: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]]
    replaces: ClassVar[tuple[str, ...]] = ()
    removes: ClassVar[tuple[str, ...]] = ()
    kind: ClassVar[str] = "force"
    stands_for: ClassVar[str] = ""
    phrase: ClassVar[str] = ""
    refines: ClassVar[tuple[str, ...]] = ()
    limits: ClassVar[Mapping[str, float]] = {}
    same_as: ClassVar[tuple[str, ...]] = ()
    carried: ClassVar[bool] = False
    relative: ClassVar[bool] = False
    instant: ClassVar[bool] = False
    forms: ClassVar[tuple[str, ...]] = ()
    settings: ClassVar[Mapping[str, float | str]] = {}
    choices: ClassVar[int] = 1
    together: ClassVar[Together] = ""
    learned: ClassVar[bool] = False
    curve: ClassVar[str] = ""

    @abstractmethod
    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Where it could sit in this mechanism: ports or sensors, by the names that verdicts use."""

    @abstractmethod
    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The mechanism with this effect in it; at null values, the physics as before (but for what it removes)."""

    def in_form(self, form: str) -> Effect:
        """The effect in one of its forms.

        Raises:
            NotFoundError: it has none of the name.
        """
        raise NotFoundError(f"form of {self.name}", form, self.forms)

    def forms_at(self, seen: np.ndarray) -> tuple[str, ...]:
        """Its forms that are another thing than the plain one at a place that was at these displacements, in any order.

        Args:
            seen: shape (T,) [m or rad]; empty where nothing reads the place.
        """
        return self.forms

    def with_parameters(self, parameters: Iterable[Parameter]) -> Self:
        """The same effect, its parameters with other scales, starts or bounds."""
        made = copy.copy(self)
        vars(made)["parameters"] = tuple(parameters)
        return made

    def towards(self, displacement: np.ndarray) -> np.ndarray:
        """How far displacements go towards where the effect begins, or beyond it, shape (T,): here either way."""
        return np.abs(displacement)

    def innate(self, values: Mapping[str, float], rate: float) -> bool:
        """Whether, with these numbers, a well-made sensor that reads at `rate` [1/s] does this by itself."""
        return False

    def elsewhere(self, mechanism: Mechanism, where: str) -> tuple[str, Effect] | None:
        """The other port that it loads as well, and the effect as who watches that port alone has it.

        None of what loads its own alone.
        """
        return None

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """Why the effect with these numbers is not what its name says, one clause; empty where it is.

        Bounds of parameters are seen to elsewhere.

        Args:
            values: of its parameters.
            sizes: typical of what was recorded at its place.
        """
        return ""

    def swinging(self, inertia: float, pace: float, ratio: float) -> Mapping[str, float]:
        """Its values with so much of its place moving by itself; empty of what lets nothing do so.

        Args:
            inertia: of what moves [kg or kg m^2].
            pace: at which it would swing on a place held still [rad/s].
            ratio: of its damping to critical damping.
        """
        return {}

    @property
    def precision(self) -> np.ndarray | None:
        """Inverse covariance of a normal prior of all its parameters about null, in their scales, shape (P, P).

        None where nothing is known of them but their bounds.
        """
        return None

    @property
    def strength(self) -> Parameter:
        """The first of its parameters that says how much there is of it."""
        return next((p for p in self.parameters if not p.shape), self.parameters[0])

    @property
    def once(self) -> bool:
        """Whether it happens at a moment of a trial, each trial's own."""
        return any(p.moment for p in self.parameters)

    @property
    def two_sided(self) -> bool:
        """Whether its first parameter, its strength, may lie on either side of nothing."""
        return self.parameters[0].lower < self.parameters[0].null

    @property
    def nulls(self) -> dict[str, float]:
        """Parameter values at which nothing changes."""
        return {p.name: p.null for p in self.parameters}

    def apply(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """`edit`, after checking place and values.

        Raises:
            NotFoundError: a place where it cannot sit, or an unknown parameter.
            InputError: a value missing or outside its bounds.
        """
        places = self.places(mechanism)
        if where not in places:
            raise NotFoundError(f"place for {self.name}", where, places)
        names = [p.name for p in self.parameters]
        for name in values:
            if name not in names:
                raise NotFoundError(f"parameter of {self.name}", name, names)
        checked = {}
        for parameter in self.parameters:
            if parameter.name not in values:
                raise InputError(f"{self.name} lacks a parameter", given=list(values), valid=", ".join(names))
            checked[parameter.name] = parameter.check(values[parameter.name], f"{self.name} at {where}")
        return self.edit(mechanism, where, checked)

    def replaced(self, where: str) -> tuple[str, ...]:
        """Names of the baseline constants that this effect, at this place, takes over from."""
        return tuple(name.format(where=where) for name in self.replaces)


def name_on(parameter: str, angular: bool) -> str:
    """A parameter's name where it acts on an angle: N becomes Nm and m becomes rad."""
    if not angular:
        return parameter
    words, *units = parameter.split("_")
    return "_".join([words, *(_ANGULAR.get(u, u) for u in units)])


_ANGULAR = {"N": "Nm", "Ns": "Nms", "Ns2": "Nms2", "m": "rad", "m2": "rad2", "m3": "rad3"}


@dataclass(frozen=True)
class Placed:
    """An effect at a place, with values: one line of a scene or a verdict."""

    effect: Effect
    where: str
    values: Mapping[str, float]

    def apply(self, mechanism: Mechanism) -> Mechanism:
        """The mechanism with this effect in it."""
        return self.effect.apply(mechanism, self.where, self.values)


def positions(mechanism: Mechanism, *names: str) -> tuple[str, ...]:
    """Those of `names` that are ports of the mechanism, and every joint port where "joint" is among them."""
    found = [n for n in names if n in mechanism.ports]
    if "joint" in names:
        found += [n for n in mechanism.ports if n.startswith("joint.")]
    return tuple(found)


BASE_PORTS = ("base", "base.y", "base.z", "base.roll", "base.pitch", "base.yaw")
"""Ports of a free base: along the approach, the lateral axis and up, and turning about them."""
