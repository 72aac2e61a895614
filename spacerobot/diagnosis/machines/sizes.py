"""Typical sizes of a recording, and effects with their parameters scaled to them."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.support.errors import InputError

STANDARD_GRAVITY = 9.80665

SMALL = 0.05
"""A fit's unit step of a parameter, as a share of its typical size."""

_POWER = re.compile(r"([a-zA-Z]+)(?:\^(\d+))?")
_PLAIN = {"1", "channel unit"}


@dataclass(frozen=True)
class Sizes:
    """What is typical in a recording, so that one catalogue serves a wrist, a drive and a circuit alike.

    Attributes:
        force: N, or N m on a joint that turns.
        length: m, or rad.
        time: s: length over typical speed.
        reading: of a sensor that may be biased, in its channel's unit.
    """

    force: float
    length: float
    time: float
    reading: float = 1.0

    def __post_init__(self) -> None:
        for name in ("force", "length", "time", "reading"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("a typical size must be positive and finite", given=value, where=name)

    @property
    def mass(self) -> float:
        """kg or kg m^2 that the typical force moves by the typical length in the typical time."""
        return self.force * self.time**2 / self.length

    def of(self, unit: str) -> float:
        """Typical size of a number with this unit; 1 where it has none."""
        if unit in _PLAIN:
            return self.reading if unit == "channel unit" else 1.0
        if unit == "rad":  # an angle against gravity: the slope that moves by the length in the time
            return self.length / self.time**2 / STANDARD_GRAVITY
        if unit == "rad/m":  # such a slope over the length
            return 1.0 / self.time**2 / STANDARD_GRAVITY
        basic = {"N": self.force, "m": self.length, "s": self.time, "kg": self.mass, "Hz": 1.0 / self.time, "1": 1.0}
        above, _, below = unit.partition("/")
        size = 1.0
        for part, sign in ((above, 1), (below, -1)):
            for name, power in _POWER.findall(part):
                if name not in basic:
                    raise InputError("unknown unit of a parameter", given=unit, valid=", ".join(basic))
                size *= basic[name] ** (sign * int(power or 1))
        return size


def sizes_of(force: np.ndarray, position: np.ndarray, velocity: np.ndarray, reading: float | None = None) -> Sizes:
    """Sizes from what was recorded, any shape each: rms of force, of position about its mean, of velocity."""
    length = float(np.std(position))
    return Sizes(
        force=float(np.sqrt(np.mean(np.square(force)))),
        length=length,
        time=length / float(np.sqrt(np.mean(np.square(velocity)))),
        reading=length if reading is None else reading,
    )


def scaled(effect: Effect, sizes: Sizes) -> Effect:
    """The same effect, with its parameters' scales and starts of these sizes; null values and bounds are kept."""
    parameters = tuple(_scaled(p, sizes) for p in effect.parameters)
    made: Effect = type(
        type(effect).__name__, (type(effect),), {"parameters": parameters, "__doc__": type(effect).__doc__}
    )()
    return made


def _scaled(parameter: Parameter, sizes: Sizes) -> Parameter:
    if parameter.unit == "1":
        return parameter
    size = sizes.of(parameter.unit)
    if parameter.unit == "s":  # delays are short against the motion, and no more than tenths of it
        starts = [0.05 * size, -0.05 * size, 0.3 * size]
    elif parameter.unit == "Hz":
        starts = [1.0 * size, 0.3 * size, 3.0 * size]
    else:
        starts = [0.1 * size, -0.1 * size, 0.5 * size]
    within = tuple(s for s in starts if parameter.lower <= s <= parameter.upper) or parameter.starts
    return replace(parameter, scale=SMALL * size, starts=within)
