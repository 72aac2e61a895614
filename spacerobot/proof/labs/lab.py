"""A lab: its rig as it is believed, its targets, and its instruments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Instrument:
    """A camera system or a force sensor.

    Attributes:
        rate: samples a second.
        sigma: of its noise [m or N].
        quantum: step of its digits.
        stated: whether the study states the noise.
    """

    rate: float
    sigma: float
    quantum: float
    stated: bool = True


CAMERA = Instrument(120.0, 1.5e-4, 1e-5)
FORCE = Instrument(1000.0, 0.25, 0.01)


@dataclass(frozen=True)
class Lab:
    """What a lab has. SI.

    Attributes:
        stiffness, damping: of the spring, and the damping that was measured with the guide taken off.
        extra: equivalent damping [N s/m].
        masses: of the targets; each is a condition of its own.
        speeds: between which the trials spread, slow and fast.
        wrist_mass: of the slider.
        contact_stiffness, contact_damping: of the tip.
        sigma: dotted name -> relative standard deviation of what is believed.
        approach: direction of the hand's motion that the target meets.
        camera, force: the instruments; None where there is no force sensor.
    """

    stiffness: float
    damping: float
    extra: float
    masses: tuple[float, ...]
    sigma: Mapping[str, float]
    speeds: tuple[float, float] = (0.045, 0.12)
    wrist_mass: float = 0.7
    contact_stiffness: float = 68000.0
    contact_damping: float = 60.0
    approach: tuple[int, int, int] = (1, 0, 0)
    camera: Instrument = field(default=CAMERA)
    force: Instrument | None = field(default=FORCE)

    @property
    def believed(self) -> dict[str, float]:
        """The rig's values by dotted name, the targets' masses apart."""
        return {
            "wrist.mass": self.wrist_mass,
            "wrist.stiffness": self.stiffness,
            "wrist.damping": self.damping,
            "wrist.equivalent_damping": self.extra,
            "contact.stiffness": self.contact_stiffness,
        }
