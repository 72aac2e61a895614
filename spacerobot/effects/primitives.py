"""The primitives into which every effect is written, and which every backend implements.

Backends know these records and nothing of effects. Ports and coordinates are named; see docs/architecture.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from spacerobot.effects.kernel import Kernel, ScalarLaw
from spacerobot.effects.memory import Memory
from spacerobot.support.errors import InputError

MAP_ORDER = ("inertia", "lever", "low_pass", "delay", "gain", "offset")
"""The kinds of channel maps, in the order in which a sensor applies them."""


def _finite(what: str, *values: float) -> None:
    for value in values:
        if not math.isfinite(value):
            raise InputError(f"{what} is not finite", given=value)


@dataclass(frozen=True)
class Coordinate:
    """One absolute degree of freedom of the reduced mechanism.

    Attributes:
        name: "hand", "wrist", "target", "target.y", "target.yaw", "joint.NAME" or an appendage's own name.
        mass: kg, or kg m^2 for an angle; positive.
        angular: whether it is an angle [rad] rather than a length [m].
        carrier: for an appendage, the body that carries it sideways and counts its weight.
    """

    name: str
    mass: float
    angular: bool = False
    carrier: str | None = None

    def __post_init__(self) -> None:
        if not (math.isfinite(self.mass) and self.mass > 0.0):
            raise InputError("mass must be positive and finite", given=self.mass, where=self.name)


@dataclass(frozen=True)
class Force:
    """A force at a port, f = kernel(d, v, aux, p), positive along the port.

    Attributes:
        name: its line in the energy ledger, e.g. "wrist.spring".
        port: where it acts.
        kernel: the law.
        p: the law's parameters, SI.
        sense: port whose displacement and rate the law reads; `port` itself if None.
        aux: port whose rate, or input whose value, the law reads as `aux`; None for zero.
        aside: a second port; `aux` is then the speed across both, which has no sign.
        role: what other effects may look for and replace: "spring", "damper", "contact" or "".
    """

    name: str
    port: str
    kernel: Kernel
    p: tuple[float, ...]
    sense: str | None = None
    aux: str | None = None
    role: str = ""
    aside: str | None = None

    @property
    def beside(self) -> tuple[str, ...]:
        """Ports that `aux` is read from."""
        return tuple(p for p in (self.aux, self.aside) if p is not None)

    def read_beside(self, rate: Callable[[str], np.ndarray]) -> np.ndarray | None:
        """What the law reads as `aux`, from the rates of these ports, shape (T,) each; None where it reads nothing."""
        rates = [rate(p) for p in self.beside]
        return None if not rates else rates[0] if len(rates) == 1 else np.hypot(*rates)

    def __post_init__(self) -> None:
        _finite(f"parameter of {self.name}", *self.p)


@dataclass(frozen=True)
class Contact:
    """Unilateral contact between two coordinates, with the contact point fixed in the target.

    With yaw psi the penetration is d = x_B + a (cos psi - 1) - b sin psi - x_A, and the tangential
    displacement is s = y_B + a sin psi + b (cos psi - 1), with the contact point (a, b) = (ahead, lateral) in the body.

    Attributes:
        kernel: the law; its force is negative in compression (it pushes the bodies apart along -d).
        p: the law's parameters.
        hold: largest tension before the surfaces part [N]; 0 for plain unilateral contact, inf never parts by force.
        bilateral: the paper's reading: the contact ends when d returns to zero, with tension before it.
        ahead, lateral: contact point from the centre of mass, in the target's body [m].
    """

    kernel: Kernel
    p: tuple[float, ...]
    hold: float = 0.0
    bilateral: bool = False
    ahead: float = 0.0
    lateral: float = 0.0
    name: str = "contact"

    def __post_init__(self) -> None:
        _finite("contact parameter", *self.p, self.ahead, self.lateral)
        if not self.hold >= 0.0:
            raise InputError("holding force must not be negative", given=self.hold, where="contact")

    def turned(self, yaw: Any) -> tuple[Any, Any]:
        """By how much the contact point is further along and across where the body is turned, shape of yaw each [m].

        The yaw's parts of d and s above.
        """
        sine, cosine = np.sin(yaw), np.cos(yaw)
        a, b = self.ahead, self.lateral
        return a * (cosine - 1.0) - b * sine, a * sine + b * (cosine - 1.0)


@dataclass(frozen=True)
class Friction:
    """A set-valued force at a port; sticking is solved by the backend, never smoothed.

    Attributes:
        name: its line in the energy ledger.
        port: where it acts.
        level: `(v, normal, d, p)` -> largest magnitude [N or N m] while sliding with rate v at displacement d; the
            sign of v is that of the sliding, +-1e-300 at rest; `normal` is the normal load [N] where `normal` names a
            contact.
        p: parameters of the level.
        normal: name of the contact that presses, or None.
        steady: whether the level depends on nothing but the direction of sliding; such friction is integrated faster.
    """

    name: str
    port: str
    level: ScalarLaw
    p: tuple[float, ...]
    normal: str | None = None
    steady: bool = False

    def __post_init__(self) -> None:
        _finite(f"parameter of {self.name}", *self.p)


@dataclass(frozen=True)
class State:
    """A force at a port that remembers: f(z, z', d, v, N) with z' = g(z, d, v, N), z a number of its own.

    At the start z is at rest: what does not change while the port stands where it is.

    Attributes:
        name: its line in the energy ledger.
        port: where it acts, and whose motion it reads.
        law: the two functions, and the energy it stores.
        p: their parameters, SI, as many as they need (a table of spline coefficients too).
        size: a typical value of z, by which its error is measured.
        normal: name of the contact that presses, or None.
    """

    name: str
    port: str
    law: Memory
    p: tuple[float, ...]
    size: float
    normal: str | None = None

    def __post_init__(self) -> None:
        _finite(f"parameter of {self.name}", *self.p)
        if not (math.isfinite(self.size) and self.size > 0.0):
            raise InputError("size of a state must be positive and finite", given=self.size, where=self.name)


@dataclass(frozen=True)
class Load:
    """A small heavy body fixed to a link, beside what the robot has there: weight and inertia, none of its own.

    Attributes:
        link: "link.NAME".
        mass: [kg]; less than nothing where the robot's model has too much.
        place: in the link's frame [m]; None where it is spread as what moves with the link's joint is.
    """

    link: str
    mass: float
    place: tuple[float, float, float] | None

    def __post_init__(self) -> None:
        _finite(f"load on {self.link}", self.mass, *(self.place or ()))


@dataclass(frozen=True)
class Field:
    """A uniform acceleration [m/s^2] of a body along a coordinate."""

    body: str
    acceleration: float
    name: str = "gravity"


@dataclass(frozen=True)
class Impulse:
    """A known kick: momentum [N s] added at a port at a time [s]."""

    port: str
    impulse: float
    time: float
    name: str = "impulse"


@dataclass(frozen=True)
class Input:
    """A recorded drive: force = gain * channel, acting at a port."""

    name: str
    port: str
    channel: str
    gain: float = 1.0


@dataclass(frozen=True)
class Readout:
    """What a channel shows: "position", "velocity" or "acceleration" of a port, or the "force" of a named element."""

    channel: str
    kind: str
    of: str
    sign: float = 1.0


@dataclass(frozen=True)
class ChannelMap:
    """What a sensor does to one channel; the maps of a channel apply in order of `rank`.

    Attributes:
        channel: which channel.
        kind: "inertia" (F - m a of port `of`), "lever" (what turns with port `of` is shown), "low_pass", "delay",
            "gain" or "offset".
        value: kg, m, Hz, s, factor, or the channel's unit.
        of: the port whose acceleration an "inertia" map reads, whose angle a "lever".
        form: order and kind of a "low_pass" map, as `filters.first_orders` takes them.
        turned: of a "lever", its angle from the channel's axis where the port has none [rad].
    """

    channel: str
    kind: str
    value: float
    of: str | None = None
    form: tuple[int, str] = (1, "butterworth")
    turned: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in MAP_ORDER:
            raise InputError("unknown kind of channel map", given=self.kind, valid=", ".join(MAP_ORDER))

    @property
    def sluggish(self) -> bool:
        """Whether it is a filter of the first order: y' = 2 pi f (u - y)."""
        return self.kind == "low_pass" and self.form[0] == 1

    def lever(self, angle: np.ndarray, rate: np.ndarray | None = None, growth: np.ndarray | None = None) -> np.ndarray:
        """What a turning lever adds to a place [m]; to its rate [m/s], or that one's, where the turning's are given.

        Args:
            angle: by which it has turned, shape (T,) [rad].
            rate: of its turning, shape (T,) [rad/s].
            growth: of that rate, shape (T,) [rad/s^2].
        """
        sine, cosine = np.sin(angle + self.turned), np.cos(angle + self.turned)
        if rate is None:
            return np.asarray(self.value * cosine)
        if growth is None:
            return np.asarray(-self.value * rate * sine)
        return np.asarray(-self.value * (rate**2 * cosine + growth * sine))

    @property
    def rank(self) -> int:
        """Order in which a sensor's maps apply."""
        return MAP_ORDER.index(self.kind)
