"""Time offset: a stream that is late, or early."""

from __future__ import annotations

from spacerobot.effects.effect import Parameter
from spacerobot.effects.sensor_effect import SensorEffect


class TimeOffset(SensorEffect):
    """A constant delay of every channel of a sensor; positive: the reading is late."""

    name = "time_offset"
    title = "time offset"
    phrase = "a time offset"
    formula = r"y(t) = u(t - \tau)"
    source = "clock offset between streams"
    map_kind = "delay"
    parameters = (Parameter("delay_s", "s", 0.0, 5e-4, -1.0, 1.0, (0.002, -0.002, 0.01)),)
    relative = True
    same_as = ("clock",)
