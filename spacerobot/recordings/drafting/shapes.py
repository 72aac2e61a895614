"""What a column of readings looks like, whatever it is called."""

from __future__ import annotations

import math

import numpy as np

from spacerobot.recordings.table import Floats

FEW_VALUES = 12
"""Different readings of a status, a switch or a command that steps; a sensor's noise makes more."""

SMOOTH = 0.1
"""Median step over the readings' scatter, below which a track is smooth: ten readings each way, and more."""


def in_steps(values: Floats) -> bool:
    """Whether a column takes a few values only.

    Args:
        values: (n,) finite.
    """
    return len(np.unique(values)) <= FEW_VALUES


def is_smooth(values: Floats) -> bool:
    """Whether a column goes on from reading to reading; a drop-out's jump is no step of it.

    Args:
        values: (n,) finite, in order.
    """
    return float(np.median(np.abs(np.diff(values)))) < SMOOTH * float(np.std(values))


def turn_of(values: Floats) -> str:
    """ "deg" or "rad" where the largest jumps are all of one turn, as an angle's that starts anew; else "".

    A turn's jump is its size less one step, and an angle that jumps spans a turn.
    """
    steps = np.abs(np.diff(values))
    for name, turn in (("deg", 360.0), ("rad", 2.0 * math.pi)):
        jumps = steps[steps > 0.5 * turn]
        if len(jumps) and 0.9 * turn < jumps.min() and np.ptp(values) <= 1.01 * turn:
            return name
    return ""
