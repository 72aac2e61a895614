"""What a doubted factor in a joint's log brings into its torque balance, to first order (`doubted.py`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.diagnosis.machines.test_functions import Bump


@dataclass(frozen=True, eq=False)
class Brought:
    """What one more of a factor adds to a log as it was read, seen through its test function. T samples, J joints."""

    position: np.ndarray  # (T, J)
    velocity: np.ndarray  # (T, J)
    acceleration: np.ndarray  # (T, J)
    torque: np.ndarray  # (T, J) that was logged
    rigid: np.ndarray  # (T, J) that the rigid body asks for

    def part(self, rows: np.ndarray) -> Brought:
        """Some of the samples."""
        return Brought(*(getattr(self, f.name)[rows] for f in fields(self)))


def brought(
    channel: str,
    column: np.ndarray,
    joints: Sequence[str],
    lens: Bump,
    thin: int,
    *,
    rates: bool,
) -> Brought:
    """What a column adds to a joint's channel; the rigid body's part is left at zero.

    Args:
        channel: "joint.NAME.position", ".velocity" or ".torque".
        column: at the log's own rate, shape (N,).
        joints: names, in the log's order.
        lens: the test function that the log is taken through.
        thin: every so manieth sample is kept.
        rates: whether velocities were logged too, so that none is taken from positions.
    """
    _, joint, kind = channel.split(".")
    k = joints.index(joint)

    def at(signal: np.ndarray) -> np.ndarray:
        out = np.zeros((signal[::thin].size, len(joints)))
        out[:, k] = signal[::thin]
        return out

    shown = at(lens.smooth(column))
    none = np.zeros_like(shown)
    if kind == "torque":
        return Brought(none, none, none, shown, none)
    if kind == "velocity":
        return Brought(none, shown, at(lens.rate(column)), none, none)
    moved = (none, none) if rates else (at(lens.rate(column)), at(lens.acceleration(column)))
    return Brought(shown, *moved, none, none)


def asked_for(
    own: Brought, motion: Sequence[np.ndarray], turn: np.ndarray | None, arm: Rigid, size: float
) -> np.ndarray:
    """How the rigid body's torque changes with the factor, shape (T, J), by a difference to both sides.

    Args:
        own: what the factor adds.
        motion: position, velocity and acceleration, shape (T, J) each.
        turn: rate of a base that floats, shape (T,).
        arm: the rigid body.
        size: of the difference: the factor's standard deviation.
    """
    (q, v, a), (dq, dv, da) = motion, (size * x for x in (own.position, own.velocity, own.acceleration))
    more, less = arm.torque(q + dq, v + dv, a + da, turn), arm.torque(q - dq, v - dv, a - da, turn)
    return np.asarray((more - less) / (2.0 * size))
