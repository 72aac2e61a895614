"""Off centre: the tracked point of a body that turns is not its centre of mass."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import SPINS, across, in_space
from spacerobot.effects.primitives import ChannelMap

TURN = SPINS[2]
AXES = {".x": 0.0, ".y": -0.5 * math.pi}
"""Ending of a channel's name -> angle of a body's own first axis from the channel's, where it has not turned [rad]."""


def levers(readouts: Iterable[str], ahead: float, aside: float) -> tuple[ChannelMap, ...]:
    """Maps of the channels along x and y whose tracked point has the centre of mass ahead of it and to its left [m]."""
    return tuple(
        ChannelMap(channel, "lever", length, TURN, turned=AXES[channel[-2:]] - back)
        for channel in readouts
        if channel[-2:] in AXES
        for length, back in ((-ahead, 0.0), (aside, 0.5 * math.pi))
    )


class OffCentre(Effect):
    """The centre of mass lies beside the point that is tracked: where the body turns, that point goes round it."""

    name = "off_centre"
    title = "centre of mass off the tracked point"
    phrase = "a centre of mass that is not the tracked point"
    formula = r"\mathbf x_\mathrm{read} = \mathbf x - R(\psi)\,(a, b)^T"
    source = "plane kinematics of a rigid body, Euler (1765)"
    kind = "sensor"
    same_as = ("com",)
    parameters = (
        Parameter("ahead_m", "m", 0.0, 2e-3, -10.0, 10.0, (0.01, -0.01)),
        Parameter("aside_m", "m", 0.0, 2e-3, -10.0, 10.0, (0.01, -0.01)),
    )

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """A body that is tracked along both axes of the plane in which it turns by itself."""
        plane = across(mechanism, "target") and TURN in mechanism.ports and not in_space(mechanism)
        return ("target",) if plane and AXES.keys() <= {channel[-2:] for channel in mechanism.readouts} else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A lever in each channel."""
        return mechanism.with_map(*levers(mechanism.readouts, values["ahead_m"], values["aside_m"]))
