"""Bias: a sensor with a wrong zero."""

from __future__ import annotations

from spacerobot.effects.effect import Parameter
from spacerobot.effects.sensor_effect import SensorEffect


class Bias(SensorEffect):
    """A constant added to every reading of a sensor, in the channel's unit."""

    name = "bias"
    title = "bias"
    phrase = "a bias"
    formula = r"y = u + b"
    source = "sensor zero"
    instant = True
    map_kind = "offset"
    parameters = (Parameter("value", "channel unit", 0.0, 0.05, -1e4, 1e4, (0.1, -0.1)),)
