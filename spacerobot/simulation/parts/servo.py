"""What holds servo joints in a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from spacerobot.simulation.parts.checks import number, vector


@dataclass(frozen=True)
class Servo:
    """What holds servo joints at the pose: one value for all joints, or one each.

    They start in equilibrium: on a fixed base each servo is deflected at t = 0 by what it carries of the arm's weight
    there, over its stiffness, so that the pose is where the arm stands and not where it would stand without gravity.

    Attributes:
        stiffness: [N m/rad or N/m].
        damping: [N m s/rad or N s/m].
    """

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
