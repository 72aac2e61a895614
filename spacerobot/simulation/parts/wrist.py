"""The compliant wrist of a scene."""

from __future__ import annotations

import math
from dataclasses import dataclass

from spacerobot.simulation.parts.checks import check_fields


@dataclass(frozen=True)
class Wrist:
    """The compliant wrist.

    Attributes:
        mass: of the slider [kg].
        stiffness: [N/m].
        damping: [N s/m].
        equivalent_damping: the constant that stands for guide friction, c_eq of the paper [N s/m].
        guide_friction: Coulomb friction of the guide [N].
        deflection: of the slider at the start, positive pushed in [m].
        deflection_rate: its rate at the start [m/s].
    """

    mass: float = 0.7
    stiffness: float = 1020.0
    damping: float = 0.0
    equivalent_damping: float = 0.0
    guide_friction: float = 0.0
    deflection: float = 0.0
    deflection_rate: float = 0.0

    def __post_init__(self) -> None:
        check_fields(
            self,
            "wrist",
            mass=(0.0, True),
            stiffness=(0.0, False),
            damping=(0.0, False),
            equivalent_damping=(0.0, False),
            guide_friction=(0.0, False),
            deflection=(-math.inf, False),
            deflection_rate=(-math.inf, False),
        )
