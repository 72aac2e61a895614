"""How far a simulation lies from a recording, in figures."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from spacerobot.diagnosis.forward.base import ChannelOverlay, TrialOverlay


@dataclass(frozen=True)
class Residuals:
    """Residuals of one channel, predicted minus measured, over one trial or several.

    Attributes:
        channel, unit: of the channel, SI.
        samples: how many.
        rms, mean, largest: of the residual; `largest` keeps its sign [unit].
        spread: standard deviation of what was measured, trial by trial, to set the rms against [unit].
        sigma: one standard deviation of the noise, root mean square over the trials [unit].
        sigma_stated: whether the study states it.
        chi2_per_sample: mean of (residual/sigma)^2; 1 is noise alone, NaN without noise to compare with.
    """

    channel: str
    unit: str
    samples: int
    rms: float
    mean: float
    largest: float
    spread: float
    sigma: float
    sigma_stated: bool
    chi2_per_sample: float

    @property
    def rms_sigmas(self) -> float:
        """The rms in standard deviations of the noise."""
        return math.sqrt(self.chi2_per_sample)

    @property
    def share(self) -> float:
        """The rms over the spread of what was measured; NaN where nothing moved."""
        return self.rms / self.spread if self.spread > 0.0 else math.nan

    def as_json(self) -> dict[str, Any]:
        """As the overlay's JSON has it."""
        return {
            "unit": self.unit,
            "samples": self.samples,
            "rms": self.rms,
            "mean": self.mean,
            "largest": self.largest,
            "spread": self.spread,
            "share_of_spread": self.share,
            "sigma": self.sigma,
            "sigma_stated": self.sigma_stated,
            "rms_sigmas": self.rms_sigmas,
            "chi2_per_sample": self.chi2_per_sample,
        }


def residuals(overlays: Iterable[ChannelOverlay]) -> Residuals:
    """The figures of one channel over its overlays, at least one."""
    parts = list(overlays)
    every = np.concatenate([o.residual for o in parts])
    weighted = np.concatenate([o.residual / o.sigma if o.sigma > 0.0 else np.full(o.time.size, np.nan) for o in parts])
    largest = every[np.argmax(np.abs(every))]
    samples = np.array([o.time.size for o in parts])

    def pooled(values: Iterable[float]) -> float:
        return float(np.sqrt(np.average(np.square(list(values)), weights=samples)))

    return Residuals(
        channel=parts[0].channel,
        unit=parts[0].unit,
        samples=every.size,
        rms=float(np.sqrt(np.mean(every**2))),
        mean=float(every.mean()),
        largest=float(largest),
        spread=pooled(float(np.std(o.measured)) for o in parts),
        sigma=pooled(o.sigma for o in parts),
        sigma_stated=all(o.sigma_stated for o in parts),
        chi2_per_sample=float(np.mean(weighted**2)),
    )


def by_channel(trials: Iterable[TrialOverlay]) -> dict[str, Residuals]:
    """The figures of every channel, all trials together, in order of appearance."""
    parts: dict[str, list[ChannelOverlay]] = {}
    for trial in trials:
        for overlay in trial.channels:
            if overlay.time.size:
                parts.setdefault(overlay.channel, []).append(overlay)
    return {channel: residuals(found) for channel, found in parts.items()}
