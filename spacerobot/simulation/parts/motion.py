"""What moves in a scene at its start, beyond target and chaser as a whole."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from spacerobot.simulation.parts.checks import number, vector
from spacerobot.support.errors import InputError


@dataclass(frozen=True)
class Motion:
    """Motion at the start that is neither the target's nor the chaser's as a whole: all at rest if nothing is said.

    Attributes:
        base_velocity: of a free base's origin, beside the speed of the chaser as a whole, world axes, shape (3,) [m/s].
        base_spin: angular velocity of a free base about its own origin, world axes, shape (3,) [rad/s].
        joint_rates: of moving joints of the chain by name [rad/s or m/s].
        carried: of bodies that others carry (a slosh mass), by coordinate: displacement from where its spring is at
            rest and its rate, both against the carrier [m and m/s, or rad and rad/s].
    """

    base_velocity: tuple[float, ...] = (0.0, 0.0, 0.0)
    base_spin: tuple[float, ...] = (0.0, 0.0, 0.0)
    joint_rates: Mapping[str, float] = field(default_factory=dict)
    carried: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("base_velocity", "base_spin"):
            object.__setattr__(self, name, vector(getattr(self, name), 3, f"motion.{name}"))
        for name in ("joint_rates", "carried"):
            if not isinstance(getattr(self, name), Mapping):
                given = getattr(self, name)
                raise InputError("must be a table", given=given, valid="NAME = value", where=f"motion.{name}")
        rates = {str(k): number(v, f"motion.joint_rates.{k}") for k, v in self.joint_rates.items()}
        carried = {
            str(k): vector(v, 2, f"motion.carried.{k}", "displacement and rate") for k, v in self.carried.items()
        }
        object.__setattr__(self, "joint_rates", rates)
        object.__setattr__(self, "carried", carried)

    @property
    def moves_robot(self) -> bool:
        """Whether base or joints move at the start."""
        return any(self.base_velocity) or any(self.base_spin) or any(self.joint_rates.values())
