"""The typical sizes of a recording, and effects with their parameters scaled to them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.sizes import Sizes

SMALL = 0.05
"""A fit's unit step of a parameter, as a share of its typical size."""


def sizes_of(force: np.ndarray, position: np.ndarray, velocity: np.ndarray, reading: float | None = None) -> Sizes:
    """Sizes from what was recorded, any shape each: rms of force, of position about its mean, of velocity."""
    length = float(np.std(position))
    return Sizes(
        force=float(np.sqrt(np.mean(np.square(force)))),
        length=length,
        time=length / float(np.sqrt(np.mean(np.square(velocity)))),
        reading=length if reading is None else reading,
    )


def scaled(effect: Effect, sizes: Sizes) -> Effect:
    """The same effect, with its parameters' scales and starts of these sizes; null values and bounds are kept."""
    parameters = tuple(_scaled(p, sizes) for p in effect.parameters)
    made: Effect = type(
        type(effect).__name__, (type(effect),), {"parameters": parameters, "__doc__": type(effect).__doc__}
    )()
    return made


def _scaled(parameter: Parameter, sizes: Sizes) -> Parameter:
    if parameter.unit == "1":
        return parameter
    size = sizes.of(parameter.unit)
    if parameter.unit == "s":  # delays are short against the motion, and no more than tenths of it
        starts = [0.05 * size, -0.05 * size, 0.3 * size]
    elif parameter.unit == "Hz":
        starts = [1.0 * size, 0.3 * size, 3.0 * size]
    elif parameter.log and parameter.shape:  # known to no power of ten
        starts = [1.0 * size, 0.1 * size, 10.0 * size]
    else:
        starts = [0.1 * size, -0.1 * size, 0.5 * size]
    within = tuple(s for s in starts if parameter.lower <= s <= parameter.upper) or parameter.starts
    return replace(parameter, scale=SMALL * size, starts=within)
