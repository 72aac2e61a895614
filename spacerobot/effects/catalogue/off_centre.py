"""Off centre: the tracked point of a body that turns is not its centre of mass."""

from __future__ import annotations

import math
from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap

TURN = "target.yaw"
QUARTER = 0.5 * math.pi


def levers(readouts: Mapping[str, object], ahead: float, aside: float) -> tuple[ChannelMap, ...]:
    """Maps of the channels along x and y whose tracked point has the centre of mass ahead of it and to its left [m]."""
    found = []
    for channel in readouts:
        if channel.endswith(".x"):
            found += [
                ChannelMap(channel, "lever", -ahead, TURN),
                ChannelMap(channel, "lever", aside, TURN, turned=-QUARTER),
            ]
        elif channel.endswith(".y"):
            found += [
                ChannelMap(channel, "lever", -ahead, TURN, turned=-QUARTER),
                ChannelMap(channel, "lever", -aside, TURN),
            ]
    return tuple(found)


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
        plane = {"target.y", TURN} <= mechanism.ports.keys() and "target.z" not in mechanism.ports
        shown = {channel[-2:] for channel in mechanism.readouts}
        return ("target",) if plane and mechanism.contact is None and {".x", ".y"} <= shown else ()

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A lever in each channel."""
        return mechanism.with_map(*levers(mechanism.readouts, values["ahead_m"], values["aside_m"]))
