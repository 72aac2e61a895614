"""What a scene is made of, each a frozen record that refuses values no rig can have."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from spacerobot.effects.effect import name_on
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.registry import effect
from spacerobot.model.inertia import inertia_fault
from spacerobot.model.shapes import solid_box
from spacerobot.support.errors import InputError, NotFoundError

LAWS = ("kelvin_voigt", "hertz", "hunt_crossley")
EXPONENTS = {"kelvin_voigt": 1.0, "hertz": 1.5, "hunt_crossley": 1.5}
TARGET_EDGE = 0.30
"""Edge [m] of the uniform cube whose inertia a target has that states none."""


def number(value: Any, where: str, *, minimum: float | None = None, strict: bool = False) -> float:
    """`value` as a finite float, checked against its lower bound.

    Raises:
        InputError: no number, not finite, or below `minimum` (or at it, where `strict`).
    """
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        raise InputError("not a number", given=value, where=where)
    found = float(value)
    if not math.isfinite(found):
        raise InputError("not a finite number", given=found, where=where)
    if minimum is not None and (found < minimum or (strict and found == minimum)):
        what = "must be positive" if strict else "must not be negative"
        raise InputError(what if minimum == 0.0 else f"must be at least {minimum:g}", given=found, where=where)
    return found


def vector(value: Any, length: int | tuple[int, ...], where: str, valid: str = "") -> tuple[float, ...]:
    """`value` as a tuple of finite floats of one of the lengths.

    Raises:
        InputError: no list, of another length, or with something in it that is no finite number.
    """
    lengths = (length,) if isinstance(length, int) else length
    if isinstance(value, str | bytes | Mapping) or not isinstance(value, Sequence | np.ndarray):
        raise InputError("not a list of numbers", given=value, valid=valid or None, where=where)
    if len(value) not in lengths:
        counts = " or ".join(str(n) for n in lengths)
        raise InputError("wrong length", given=f"{len(value)} values", valid=valid or f"{counts} numbers", where=where)
    return tuple(number(v, f"{where}[{i}]") for i, v in enumerate(value))


def _checked(record: object, **bounds: tuple[float, bool]) -> None:
    for name, (minimum, strict) in bounds.items():
        object.__setattr__(
            record, name, number(getattr(record, name), f"{_where(record)}.{name}", minimum=minimum, strict=strict)
        )


def _where(record: object) -> str:
    return str(type(record).WHERE)  # type: ignore[attr-defined]


@dataclass(frozen=True)
class Wrist:
    """The compliant wrist.

    Attributes:
        mass: of the slider [kg].
        stiffness: [N/m].
        damping: [N s/m].
        equivalent_damping: the constant that stands for guide friction, c_eq of the paper [N s/m].
        guide_friction: Coulomb friction of the guide [N].
    """

    WHERE = "wrist"
    mass: float = 0.7
    stiffness: float = 1020.0
    damping: float = 0.0
    equivalent_damping: float = 0.0
    guide_friction: float = 0.0

    def __post_init__(self) -> None:
        _checked(
            self,
            mass=(0.0, True),
            stiffness=(0.0, False),
            damping=(0.0, False),
            equivalent_damping=(0.0, False),
            guide_friction=(0.0, False),
        )


@dataclass(frozen=True)
class ContactLaw:
    """How the surfaces push: F = k d_ref (d/d_ref)^n (1 + (chi/k) d') + c d', with d_ref = 1 mm.

    Attributes:
        stiffness: k [N/m].
        damping: c [N s/m].
        law: "kelvin_voigt" (n = 1, chi = 0), "hertz" (n = 1.5, chi = 0) or "hunt_crossley" (n = 1.5, c = 0).
        exponent: n, if another than the law's own.
        chi_over_k: chi/k of Hunt and Crossley [s/m].
        bilateral: the paper's reading: the contact pulls, and ends when the penetration is back at zero.
        mu: Coulomb friction coefficient at the point.
        adhesion: tension that the surfaces bear before they part [N].
    """

    WHERE = "contact"
    stiffness: float = 68000.0
    damping: float = 0.0
    law: str = "kelvin_voigt"
    exponent: float | None = None
    chi_over_k: float = 0.0
    bilateral: bool = False
    mu: float = 0.0
    adhesion: float = 0.0

    def __post_init__(self) -> None:
        _checked(
            self,
            stiffness=(0.0, True),
            damping=(0.0, False),
            chi_over_k=(0.0, False),
            mu=(0.0, False),
            adhesion=(0.0, False),
        )
        if self.law not in LAWS:
            raise NotFoundError("contact law", str(self.law), LAWS, where="contact.law")
        if not isinstance(self.bilateral, bool):
            raise InputError("must be true or false", given=self.bilateral, where="contact.bilateral")
        if self.exponent is not None:
            found = number(self.exponent, "contact.exponent", minimum=0.5)
            object.__setattr__(self, "exponent", found)
            if self.law == "kelvin_voigt" and found != 1.0:
                raise InputError(
                    "kelvin_voigt has exponent 1", given=found, valid='law = "hertz"', where="contact.exponent"
                )
        if self.chi_over_k > 0.0 and self.law != "hunt_crossley":
            raise InputError(
                f"{self.law} has no chi_over_k",
                given=self.chi_over_k,
                valid='law = "hunt_crossley"',
                where="contact.chi_over_k",
            )
        if self.damping > 0.0 and self.law == "hunt_crossley":
            raise InputError(
                "hunt_crossley takes its damping from chi_over_k", given=self.damping, where="contact.damping"
            )
        if self.bilateral and self.adhesion > 0.0:
            raise InputError("a bilateral contact pulls already", given=self.adhesion, where="contact.adhesion")

    @property
    def parameters(self) -> tuple[float, float, float, float]:
        """(k, c, n, chi/k) as the contact kernel reads them."""
        n = EXPONENTS[self.law] if self.exponent is None else self.exponent
        return self.stiffness, self.damping, n, self.chi_over_k


@dataclass(frozen=True)
class Target:
    """The free-flying body.

    With zero attitude its body axes are (approach, lateral, up), see `Scene.axes`.

    Attributes:
        mass: [kg].
        inertia: about the centre of mass in body axes [kg m^2]: three principal moments or 3 by 3; that of a
            uniform cube of 0.30 m if None and no yaw_inertia is given.
        yaw_inertia: all three moments alike [kg m^2]; instead of `inertia`.
        contact_point: (ahead, lateral) or (ahead, lateral, up) of the centre of mass, body axes [m].
        attitude: roll, pitch, yaw of the body in the approach axes at the start [rad].
        spin: angular velocity at the start, world axes [rad/s].
        speed: along `approach` at the start [m/s].
        gap: from the contact point to the wrist's tip at the start, along `approach` [m].
    """

    WHERE = "target"
    mass: float = 9.0
    inertia: Any = None
    yaw_inertia: float | None = None
    contact_point: tuple[float, ...] = (0.0, 0.0, 0.0)
    attitude: tuple[float, ...] = (0.0, 0.0, 0.0)
    spin: tuple[float, ...] = (0.0, 0.0, 0.0)
    speed: float = 0.1
    gap: float = 0.0

    def __post_init__(self) -> None:
        _checked(self, mass=(0.0, True))
        put = lambda name, value: object.__setattr__(self, name, value)  # noqa: E731
        point = vector(self.contact_point, (2, 3), "target.contact_point", "ahead, lateral and perhaps up")
        put("contact_point", (*point, 0.0)[:3])
        put("attitude", vector(self.attitude, 3, "target.attitude", "roll, pitch, yaw"))
        put("spin", vector(self.spin, 3, "target.spin"))
        put("speed", number(self.speed, "target.speed"))
        put("gap", number(self.gap, "target.gap"))
        if self.gap < 0.0:
            raise InputError(
                "the scene starts in penetration", given=self.gap, valid="a gap of zero or more", where="target.gap"
            )
        if self.yaw_inertia is not None:
            if self.inertia is not None:
                raise InputError("inertia and yaw_inertia are both given", valid="one of them", where="target")
            put("yaw_inertia", number(self.yaw_inertia, "target.yaw_inertia", minimum=0.0, strict=True))
        if self.inertia is not None:
            put("inertia", _inertia(self.inertia))
        fault = inertia_fault(self.mass, self.inertia_matrix())
        if fault:
            raise InputError(f"target cannot exist: {fault}", where="target.inertia")

    def inertia_matrix(self) -> np.ndarray:
        """Shape (3, 3), about the centre of mass, body axes [kg m^2]."""
        if self.inertia is not None:
            return np.array(self.inertia)
        if self.yaw_inertia is not None:
            return self.yaw_inertia * np.eye(3)
        return np.asarray(solid_box(self.mass, (TARGET_EDGE, TARGET_EDGE, TARGET_EDGE)))


def _inertia(given: Any) -> tuple[tuple[float, ...], ...]:
    where, valid = "target.inertia", "three moments, or three rows of three"
    if not isinstance(given, Sequence | np.ndarray) or isinstance(given, str) or len(given) != 3:
        raise InputError("inertia has the wrong shape", given=given, valid=valid, where=where)
    if all(isinstance(row, Sequence | np.ndarray) for row in given):
        rows = tuple(vector(row, 3, f"{where}[{i}]") for i, row in enumerate(given))
        if not np.allclose(rows, np.transpose(rows), rtol=1e-9, atol=0.0):
            raise InputError("inertia is not symmetric", given=rows, where=where)
        return rows
    return tuple(tuple(row) for row in np.diag(vector(given, 3, where, valid)).tolist())


@dataclass(frozen=True)
class Servo:
    """What holds servo joints at the pose: one value for all joints, or one each.

    Attributes:
        stiffness: [N m/rad or N/m].
        damping: [N m s/rad or N s/m].
    """

    WHERE = "servo"
    stiffness: Any = 1e4
    damping: Any = 0.0

    def per_joint(self, names: Sequence[str]) -> list[tuple[float, float]]:
        """(stiffness, damping) of each joint."""
        columns = []
        for what in ("stiffness", "damping"):
            value = getattr(self, what)
            if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str):
                values = vector(value, len(names), f"servo.{what}", f"one, or one for each of {', '.join(names)}")
            else:
                values = (number(value, f"servo.{what}"),) * len(names)
            columns.append([number(v, f"servo.{what}", minimum=0.0) for v in values])
        return list(zip(*columns, strict=True))


@dataclass(frozen=True)
class EffectAt:
    """An effect of the catalogue at a place, with values.

    Attributes:
        effect: its name.
        where: its place.
        parameters: name -> value; on a joint that turns, N may be written Nm and m rad.
    """

    effect: str
    where: str
    parameters: Mapping[str, float] = field(default_factory=dict)

    def apply(self, mechanism: Mechanism) -> Mechanism:
        """The mechanism with this effect in it.

        Raises:
            NotFoundError: unknown effect, place or parameter.
            InputError: a value missing, not a number, or outside its bounds.
        """
        found = effect(self.effect)
        angular = {name_on(p.name, True): p.name for p in found.parameters}
        turns = self.where in mechanism.ports and mechanism.angular(self.where)
        values = {}
        for name, value in self.parameters.items():
            if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
                raise InputError("not a number", given=value, where=f"{self.effect} at {self.where}: {name}")
            values[angular.get(name, name) if turns else name] = float(value)
        return found.apply(mechanism, self.where, values)
