"""Low-pass: a sensor that smooths what it reads."""

from __future__ import annotations

import math
from collections.abc import Mapping

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.filters import KINDS, ORDERS, PLAIN, HigherOrder
from spacerobot.effects.sensor_effect import SensorEffect
from spacerobot.effects.sizes import Sizes

NONE = 1e4
"""Times a filter's time constant that the motion's own time is, from which on no fit sees it."""

QUICK = 0.5
"""A filter's time constant is at most this share of the motion's own time: a slower one shows another motion."""


class LowPass(SensorEffect):
    """A filter on every channel of a sensor: of the first order, or in one of its forms."""

    name = PLAIN
    title = "low-pass filter"
    phrase = "a low-pass filter"
    formula = r"\dot y = 2\pi f_c (u - y)"
    source = "first-order filter"
    map_kind = PLAIN
    parameters = (Parameter("cutoff_Hz", "Hz", math.inf, 20.0, 0.01, math.inf, (100.0, 30.0, 300.0), log=True),)
    forms = tuple(f"{order}_{kind}" for order in ORDERS if order > 1 for kind in KINDS)

    def in_form(self, form: str) -> Effect:
        """A filter of higher order, e.g. "4_bessel"."""
        if form not in self.forms:
            return super().in_form(form)
        return HigherOrder(self, form)

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """A sensor that needs longer to settle than this would blur the motion itself; one that needs next to no time
        shows it as it is."""
        cutoff = values["cutoff_Hz"]
        times = 2.0 * math.pi * cutoff * sizes.time  # the motion's own time over the filter's
        if times * QUICK <= 1.0:
            return f"a filter at {cutoff:.3g} Hz would blur the motion itself"
        return "" if times < NONE else f"a filter at {cutoff:.3g} Hz changes nothing that is read"
