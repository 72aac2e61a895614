"""Scale: a sensor with a wrong gain."""

from __future__ import annotations

from spacerobot.effects.effect import Parameter
from spacerobot.effects.sensor_effect import SensorEffect


class Scale(SensorEffect):
    """Every reading of a sensor multiplied by a factor."""

    name = "scale"
    title = "scale"
    phrase = "a scale"
    formula = r"y = g\, u"
    source = "sensor gain"
    instant = True
    map_kind = "gain"
    parameters = (Parameter("factor", "1", 1.0, 0.005, 0.1, 10.0, (1.02, 0.98)),)
