"""How a joint's torque is logged: the motor's constant and the log's zero, as the baseline believes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from spacerobot.diagnosis.machines.measured import through_sensor
from spacerobot.diagnosis.machines.test_functions import Bump
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


def late(values: Mapping[str, float], joint: str) -> float:
    """By how much a joint's logged torque is late beside its motion [s]; 0 if nothing is said."""
    return values.get(f"joint.{joint}.delay", 0.0)


def logged(values: Mapping[str, float], joint: str) -> tuple[ChannelMap, ...]:
    """From the joint's torque to its log: (torque + bias) / gain, late; nothing where the baseline says nothing."""
    factor, zero, delay = gain(values, joint), bias(values, joint), late(values, joint)
    channel = f"joint.{joint}.torque"
    maps = (
        (ChannelMap(channel, "delay", delay), delay != 0.0),
        (ChannelMap(channel, "gain", 1.0 / factor), factor != 1.0),
        (ChannelMap(channel, "offset", zero / factor), zero != 0.0),
    )
    return tuple(m for m, said in maps if said)


def beside_motion(maps: Sequence[ChannelMap], joint: str) -> tuple[ChannelMap, ...]:
    """How a joint's torque is logged beside its motion: where its encoder is late, the torque is early.

    Args:
        maps: of all sensors.
        joint: "joint.NAME".
    """
    own = [m for m in maps if m.channel == f"{joint}.torque"]
    encoder = [m for m in maps if m.channel == f"{joint}.position" and m.kind == "delay"]
    return (*own, *(ChannelMap(f"{joint}.torque", "delay", -m.value) for m in encoder))


def inverse(maps: Sequence[ChannelMap], joint: str, reading: np.ndarray, step: float) -> np.ndarray:
    """A joint's torque from what is logged of it on an even grid, shape (T,) both: its scale, zero and delay undone.

    Args:
        maps: of this joint's torque, as `beside_motion` has them.
        joint: "joint.NAME".
        reading: the log.
        step: of the grid [s].
    """
    for m in sorted((m for m in maps if m.channel == f"{joint}.torque"), key=lambda m: -m.rank):
        if m.kind == "gain" and m.value:
            reading = reading / m.value
        elif m.kind == "offset":
            reading = reading - m.value
        elif m.kind == "delay" and m.value:
            grid = np.arange(reading.size) * step
            reading = np.interp(grid + m.value, grid, reading)
    return reading


def seen(maps: Sequence[ChannelMap], torque: np.ndarray, log: np.ndarray | None, bump: Bump) -> np.ndarray:
    """What a log shows of a joint's torque through a test function, shape (T - 2 n,) of (T,).

    A sluggish log is asked how it changes, y = u - y' / (2 pi f): a filter on the torque that the motion asks for would
    smooth the noise of the motion, and a fit would take that for a sensor's.

    Args:
        maps: of this joint's torque sensor.
        torque: that the joint has.
        log: what was logged of it; None of a motion that nobody made.
        bump: the test function.
    """
    late = sum(m.value for m in maps if m.kind == "delay")
    slow = [m for m in maps if m.sluggish and log is not None]
    rest = tuple(m for m in maps if m.kind != "delay" and m not in slow)
    out = bump.late(through_sensor(rest, torque, bump.step), late)
    if log is not None and slow:
        out = out - sum(1.0 / m.value for m in slow) / (2.0 * np.pi) * bump.rate(log)
    return out
