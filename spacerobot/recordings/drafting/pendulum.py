"""A pendulum that swings freely: told by its swings, with the length that its period asks for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.recordings.drafting.approach import CERTAIN, Track
from spacerobot.recordings.drafting.columns import Reading
from spacerobot.recordings.drafting.groups import Trial
from spacerobot.recordings.drafting.lines import Line
from spacerobot.recordings.drafting.tracks import track
from spacerobot.recordings.series import estimate_noise
from spacerobot.recordings.units import UNITS

URDF = """<?xml version="1.0"?>
<!-- A pendulum, written by `study new`: 1 kg on a rod whose length gives the period seen. State your own. -->
<robot name="pendulum">
  <link name="frame"/>
  <link name="bob">
    <inertial>
      <origin xyz="0 0 {below:.5g}"/>
      <mass value="1"/>
      <inertia ixx="{small:.3g}" ixy="0" ixz="0" iyy="{small:.3g}" iyz="0" izz="{small:.3g}"/>
    </inertial>
  </link>
  <joint name="axis" type="revolute">
    <parent link="frame"/><child link="bob"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1000" upper="1000" effort="1e6" velocity="1e4"/>
  </joint>
</robot>
"""

GRAVITY = 9.80665
"""m/s2, standard."""

FEWEST = 6
"""Times that a swing passes its middle, at least: three periods."""

LATEST = (3, 2, 1)
"""The last part of a trial that is looked at, as one in so many: swings are smallest there, and nearest to a sine. More
of it where that has too few."""

EVEN = 0.1
"""Share by which the halves of a period may differ: a tenth, as its middle is found to a few hundredths of a swing."""


@dataclass(frozen=True)
class Swing:
    """How a pendulum swings.

    Attributes:
        period: of its small swings [s].
        middle: where it hangs [rad].
        error: of `middle` [rad].
    """

    period: float
    middle: float
    error: float


def swing_of(
    readings: Mapping[str, Sequence[Reading]],
    trials: Sequence[Trial],
    named: Mapping[str, Sequence[Reading]],
    *,
    turns: bool = False,
) -> tuple[str, Swing] | None:
    """The stream of the one angle that is measured and its swing; None where something drives it, or it does not swing.

    Args:
        readings: stream -> what its columns seem to be.
        trials: the trials.
        named: stream -> what their names alone say; a column of which they say nothing may be an angle [rad].
        turns: whether the only joint is known to turn, so that what states no unit is an angle.
    """
    every = [(stream, r) for stream, found in readings.items() for r in found if r.quantity]
    angles = [(s, r) for s, r in every if r.quantity == "position" and not r.command]
    if len(angles) != 1 or any(r.quantity not in ("position", "velocity") or r.command for _, r in every):
        return None
    stream, reading = angles[0]
    silent = turns or any(r.column == reading.column and not r.quantity for r in named[stream])
    if not ((silent and reading.unit is None) or (reading.unit and UNITS[reading.unit].dimension == "angle")):
        return None
    seen = [t for trial in trials if stream in trial.files and (t := track(trial.files[stream], reading.column))]
    tracks = [Track(t.time, UNITS[reading.unit or "rad"].factor * t.value) for t in seen]
    found = [s for s in map(swing, tracks) if s is not None]
    if not found or 2 * len(found) < len(tracks):
        return None
    medians = (float(np.median([getattr(s, name) for s in found])) for name in ("period", "middle", "error"))
    return stream, Swing(*medians)


def swing(own: Track) -> Swing | None:
    """The swing in the last part of a trial, in rad; None where it does not swing evenly."""
    for part in LATEST:
        last = own.time >= own.time[-1] - (own.time[-1] - own.time[0]) / part
        time, value = own.time[last], own.value[last]
        middle = 0.5 * (float(np.quantile(value, 0.01)) + float(np.quantile(value, 0.99)))
        noise, size = estimate_noise(value), 0.5 * float(np.ptp(value))
        side = np.where(np.abs(value - middle) > max(3 * noise, 0.1 * size), np.sign(value - middle), 0)
        clear = np.flatnonzero(side)
        turns = clear[1:][np.diff(side[clear]) != 0]
        if len(turns) >= FEWEST:
            break
    else:
        return None
    peaks = np.array([np.abs(part - middle).max() for part in np.split(value, turns)[1:-1]])
    if not size > 10 * noise or np.any(peaks[1:] > (1.0 + EVEN) * peaks[:-1] + 3 * noise):  # no swing grows by itself
        return None
    halves = np.diff(time[turns])
    period = float(np.median(halves[1:] + halves[:-1]))
    if np.std(halves[1:] + halves[:-1]) > EVEN * period:
        return None
    wide = 1.0 + size**2 / 16 + 11 * size**4 / 3072  # a simple pendulum's period over that of its small swings
    return Swing(period / wide, middle, max(noise, EVEN * size))


def hang(line: Line, swing: Swing, rest: float = 0.0) -> None:
    """Take off what it reads at rest, where it is certain that its joint is elsewhere there.

    Args:
        line: of the angle.
        swing: as it reads.
        rest: where the joint hangs, by its URDF [rad].
    """
    far = swing.middle - rest
    if abs(far) > CERTAIN * swing.error:
        upright = math.copysign(math.pi, far)  # counted from there, it hangs half a turn away exactly
        exact = abs(far - upright) < CERTAIN * swing.error
        middle = (upright if exact else far) / UNITS[line.reading.unit or "rad"].factor
        line.offset = -float(f"{middle:.10g}" if exact else f"{middle:.4g}")
        where = f"{rest:.3g} rad where it hangs, as the URDF has it" if rest else "0 where it hangs"
        line.remark = "; ".join(r for r in (line.remark, where) if r)


def pendulum_urdf(swing: Swing) -> str:
    """A point of 1 kg on a rod of the length l with 2 pi sqrt(l/g) = period."""
    length = GRAVITY * (swing.period / (2 * np.pi)) ** 2
    return URDF.format(below=-length, small=1e-3 * length**2)
