"""What was simulated and what was recorded of a trial, at the times of its film."""

from __future__ import annotations

import math

import numpy as np

from spacerobot.diagnosis.forward.base import ChannelOverlay
from spacerobot.view.scene3d.film import Array, Readout

FRAMES = 420
"""Of a film at most; a third of them where it is worth a close look."""

_SHOWN = {"m": ("mm", 1e3), "rad": ("°", 180.0 / math.pi)}


class Tracks:
    """Simulated and measured channels at the film's times."""

    def __init__(self, channels: dict[str, ChannelOverlay], lead: str) -> None:
        self.channels = channels
        times = channels[lead].time
        count = min(len(times), FRAMES)
        even = np.linspace(times[0], times[-1], count * 2 // 3)
        focus = next((c.focus for c in channels.values() if c.focus is not None), None)
        low, high = np.clip(focus if focus is not None else (times[0], times[-1]), times[0], times[-1])
        dense = np.linspace(float(low), float(high), count // 3)
        self.time: Array = np.unique(np.round(np.concatenate([even, dense]), 9))

    def simulated(self, name: str) -> Array:
        """(T,); zero for a channel that is not there."""
        return self._at(name, "simulated")

    def measured(self, name: str) -> Array:
        """(T,); zero for a channel that is not there."""
        return self._at(name, "measured")

    def mismatch(self, *names: str) -> Array:
        """(T,), the greatest distance of the channels in their sigmas; zero where none has a known one."""
        worst = np.zeros(len(self.time))
        for name in names:
            c = self.channels.get(name)
            if c is not None and c.sigma > 0.0 and math.isfinite(c.sigma):
                worst = np.maximum(worst, np.abs(self.simulated(name) - self.measured(name)) / c.sigma)
        return worst

    def _at(self, name: str, which: str) -> Array:
        c = self.channels.get(name)
        if c is None:
            return np.zeros(len(self.time))
        found: Array = np.interp(self.time, c.time, getattr(c, which))
        return found

    def readouts(self, *names: str) -> tuple[Readout, ...]:
        """Simulated and recorded, of the channels that are there."""
        found = []
        for name in names:
            if name in self.channels:
                unit, factor = _SHOWN.get(self.channels[name].unit, (self.channels[name].unit, 1.0))
                digits = 1 if factor > 1.0 else 2
                found.append(Readout(name, unit, factor * self.simulated(name), digits, factor * self.measured(name)))
        return tuple(found)
