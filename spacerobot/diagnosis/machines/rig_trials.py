"""What a wrist rig's trials begin with: the free approach, the touch that ends it, and clocks of their own."""

from __future__ import annotations

import numpy as np

from spacerobot.diagnosis.machines.contract import CLOCK, Nuisance, Predicted
from spacerobot.diagnosis.terms.alignment import LEAST, NEAR
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.mechanism import Mechanism

CHANNEL_OF = {"target": "target.x", "target.y": "target.y", "target.yaw": "target.yaw"}
"""The channel that shows a coordinate before contact."""

CLOCK_SCALE = 1e-4
"""Step [s] of a clock's offset in a fit: a force that rises within milliseconds tells it to some hundredths of one."""

ONSET_MASK = 0.7e-3
"""Force samples this close [s] to a predicted touch are left out: the force jumps there."""


def touch_time(trial: TrialData) -> float:
    """When the target first comes as near as it may be touching, from its own track."""
    time, value, _ = trial.channel("target.x")
    beyond = np.flatnonzero(value > -NEAR)
    return float(time[beyond[0]]) if beyond.size else float(time[-1])


def free_until(time: np.ndarray, touch: float) -> np.ndarray:
    """Which readings are of the free approach, shape (T,) bool; the first few where hardly any precede the touch."""
    early = time < touch
    return early if early.sum() >= LEAST else np.arange(time.size) < max(LEAST, time.size // 20)


def nuisances_of(trial: TrialData, turning: bool, sideways: bool) -> tuple[Nuisance, ...]:
    """What is free in a trial alone: where its target is and how fast, and the offset of each clock of its own."""
    found: list[Nuisance] = []
    wanted = [("target", "target.x", 5e-5, 1e-4)]
    if sideways and "target.y" in trial.channels:
        wanted.append(("target.y", "target.y", 5e-5, 1e-4))
    if turning and "target.yaw" in trial.channels:
        wanted.append(("target.yaw", "target.yaw", 1e-4, 3e-4))
    touch = touch_time(trial)
    for coordinate, channel, scale, rate_scale in wanted:
        time, value, _ = trial.channel(channel)
        early = free_until(time, touch)
        slope, offset = np.polyfit(time[early] - trial.start, value[early], 1)
        found.append(Nuisance(coordinate, False, float(offset), scale))
        found.append(Nuisance(coordinate, True, float(slope), rate_scale))
    clocks = dict.fromkeys(b.clock for b in trial.blocks if b.clock)
    return (*found, *(Nuisance(CLOCK + clock, False, 0.0, CLOCK_SCALE) for clock in clocks))


def lateness(trial: TrialData, nuisances: tuple[Nuisance, ...], initial: np.ndarray) -> tuple[float, ...]:
    """By how much each block of a trial is late as its own clock goes [s]."""
    of = {n.coordinate: float(v) for n, v in zip(nuisances, initial, strict=True) if n.coordinate.startswith(CLOCK)}
    return tuple(of.get(CLOCK + b.clock, 0.0) for b in trial.blocks)


def counted(mechanism: Mechanism, trial: TrialData, shown: Predicted) -> np.ndarray:
    """Samples that count, shape (S,) bool: forces are left out around each touch as their sensor sees it."""
    keep = trial.valid
    if not shown.touches or "contact.force" not in trial.channels:
        return keep
    keep = keep.copy()
    late = sum(m.value for m in mechanism.maps if m.channel == "contact.force" and m.kind == "delay")
    row = 0
    for block, by in zip(trial.blocks, shown.late or (0.0,) * len(trial.blocks), strict=True):
        at = np.array(shown.touches) + (late + by)
        for channel in block.channels:
            if channel == "contact.force":
                first, last = np.searchsorted(block.time, [at - ONSET_MASK, at + ONSET_MASK])
                for a, b in zip(first.tolist(), last.tolist(), strict=True):
                    keep[row + a : row + b] = False
            row += block.time.size
    return keep
