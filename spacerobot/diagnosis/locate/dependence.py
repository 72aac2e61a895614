"""What a residual may depend on: functions of the measured motion and force, one family per kind of balance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.locate.balances import LAW, STILL, Balance
from spacerobot.diagnosis.locate.laws import depth_of
from spacerobot.diagnosis.locate.weak_trial import WeakTrial
from spacerobot.effects.mechanism import Mechanism

LARGE = 0.85
"""Displacements beyond this share of the study's largest, on either side, are large."""

FREQUENCY = "frequency"


@dataclass(frozen=True)
class Extent:
    """Largest displacements of a balance's port over all trials: (negative side, positive side) [m or rad]."""

    low: float
    high: float

    def large(self, d: np.ndarray) -> np.ndarray:
        """How far beyond the threshold, signed, zero below it, shape of d."""
        return np.maximum(d - LARGE * self.high, 0.0) + np.minimum(d - LARGE * self.low, 0.0)


def regressors(weak: WeakTrial, mechanism: Mechanism, balance: Balance, extent: Extent) -> dict[str, np.ndarray]:
    """Force patterns at the trial's nodes by what they depend on, shape (Q,) each.

    Motion counts where it stands clear of its noise, so that no pattern is made of the noise it is tested against.
    """
    if balance.kind == LAW:
        return _of_contact(weak, mechanism)
    if balance.kind == STILL:
        return {"constant": np.ones(weak.nodes.shape), "force": weak.pressing(weak.nodes)}
    state = weak.port_state(balance.row, weak.nodes)
    d, v = state.moved, state.moving
    return {
        "constant": np.full(weak.nodes.shape, balance.mass),
        "displacement": d,
        "displacement^3": d**3,
        "large displacement": extent.large(d),
        "velocity": v,
        "sign of velocity": np.sign(v),
        "velocity^2": v * np.abs(v),
        "direction of motion": np.abs(np.sign(v)),
        "force": weak.pressing(weak.nodes),
    }


def _of_contact(weak: WeakTrial, mechanism: Mechanism) -> dict[str, np.ndarray]:
    contact = mechanism.contact
    assert contact is not None  # a balance of this kind exists only with one
    d = depth_of(contact.kernel, contact.p)(weak.pressing(weak.nodes))
    v = np.gradient(d, weak.nodes)
    return {
        "constant": np.ones(weak.nodes.shape),
        "displacement": d,
        "displacement^2": d**2,
        "velocity": v,
        "displacement times velocity": d * v,
    }


def oscillation(weak: WeakTrial, frequency: float) -> np.ndarray:
    """Sine and cosine of a frequency [Hz] from the first touch on (from the start without one), shape (2, Q)."""
    begin = weak.touches.first if weak.touches.stretches else weak.start
    phase = 2.0 * np.pi * frequency * (weak.nodes - begin)
    on = weak.nodes >= begin
    return np.where(on, np.array([np.sin(phase), np.cos(phase)]), 0.0)


def extents(trials: Mapping[str, WeakTrial], found: Mapping[str, Mapping[str, Balance]]) -> dict[str, Extent]:
    """Balance -> largest displacements over all trials."""
    out: dict[str, Extent] = {}
    for key, weak in trials.items():
        for name, balance in found[key].items():
            if not balance.row:
                out[name] = Extent(0.0, 0.0)
                continue
            d = weak.port_state(balance.row, weak.nodes).moved
            old = out.get(name, Extent(0.0, 0.0))
            out[name] = Extent(min(old.low, float(d.min())), max(old.high, float(d.max())))
    return out
