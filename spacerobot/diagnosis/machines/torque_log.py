"""How a joint's torque is logged: the motor's constant and the log's zero, as the baseline believes them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from spacerobot.effects.primitives import ChannelMap

UNITS = {"gain": "1"}
"""What a study may leave unknown of it; a zero of unknown sign is the effect `preload` or `bias`."""


def gain(values: Mapping[str, float], joint: str) -> float:
    """Torque [N m] or force [N] at the joint for one unit of what is logged as its torque; 1 if nothing is said."""
    return values.get(f"joint.{joint}.gain", 1.0)


def bias(values: Mapping[str, float], joint: str) -> float:
    """What the log, times the gain, shows where there is no torque [N m or N]; 0 if nothing is said."""
    return values.get(f"joint.{joint}.bias", 0.0)


def torque(values: Mapping[str, float], joint: str, reading: np.ndarray) -> np.ndarray:
    """The joint's torque or force [N m or N], from what is logged of it, shape (T,) both."""
    return gain(values, joint) * reading - bias(values, joint)


def logged(values: Mapping[str, float], joint: str) -> tuple[ChannelMap, ...]:
    """From the joint's torque to its log: (torque + bias) / gain; nothing where the baseline says nothing."""
    factor, zero = gain(values, joint), bias(values, joint)
    channel = f"joint.{joint}.torque"
    scaled = (ChannelMap(channel, "gain", 1.0 / factor),) if factor != 1.0 else ()
    return (*scaled, ChannelMap(channel, "offset", zero / factor)) if zero else scaled
