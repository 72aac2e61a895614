"""What is typical in a recording: the measure by which an effect's numbers are large or small."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from spacerobot.support.errors import InputError

STANDARD_GRAVITY = 9.80665

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
