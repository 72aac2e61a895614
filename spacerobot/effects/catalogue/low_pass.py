"""Low-pass: a sensor that smooths what it reads."""

from __future__ import annotations

import math

from spacerobot.effects.effect import Parameter
from spacerobot.effects.sensor_effect import SensorEffect


class LowPass(SensorEffect):
    """A first-order filter on every channel of a sensor."""

    name = "low_pass"
    title = "low-pass filter"
    formula = r"\dot y = 2\pi f_c (u - y)"
    source = "first-order filter"
    map_kind = "low_pass"
    parameters = (Parameter("cutoff_Hz", "Hz", math.inf, 20.0, 0.01, math.inf, (100.0, 30.0, 300.0), log=True),)
