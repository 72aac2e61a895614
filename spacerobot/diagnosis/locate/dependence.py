"""What a residual may depend on: functions of the measured motion and force, one family per kind of balance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.locate.balances import BODY, LAW, STILL, Balance
from spacerobot.diagnosis.locate.laws import depth_of, linear_coefficients
from spacerobot.diagnosis.locate.prepared import Prepared
from spacerobot.diagnosis.locate.weak_trial import WeakTrial
from spacerobot.effects.mechanism import Mechanism

LARGE = (0.6, 0.7, 0.8, 0.86, 0.9, 0.94, 0.97)
"""Where "large" displacements may begin, as shares of the study's largest on either side; the best one counts."""

LOSS = 0.03
"""Damping ratio of a hidden resonator while it is sought; about half a decade around it look alike."""

FREQUENCY = "frequency"


@dataclass(frozen=True)
class Extent:
    """How far a balance's port went in all trials.

    Attributes:
        low, high: largest displacements to either side [m or rad].
        held: largest known load on it while it rested [N or N m].
    """

    low: float
    high: float
    held: float

    def large(self, d: np.ndarray, share: float) -> np.ndarray:
        """How far beyond the threshold, signed, zero below it, shape of d."""
        return np.maximum(d - share * self.high, 0.0) + np.minimum(d - share * self.low, 0.0)


@dataclass(frozen=True, eq=False)
class Pattern:
    """A force pattern at the nodes in one or several variants, of which the best counts. V variants.

    Attributes:
        values: shape (V, Q).
        at: what distinguishes the variants (a frequency [Hz], a threshold [m or rad]), shape (V,); nan if nothing.
    """

    values: np.ndarray
    at: np.ndarray

    @classmethod
    def single(cls, values: np.ndarray) -> Pattern:
        """Without variants; shape (Q,)."""
        return cls(values[None, :], np.array([np.nan]))


def regressors(
    weak: WeakTrial, mechanism: Mechanism, balance: Balance, extent: Extent, frequencies: np.ndarray
) -> dict[str, Pattern]:
    """Force patterns of a balance by what they depend on.

    Motion counts where it stands clear of its noise, so that no pattern is made of the noise it is tested against.
    """
    if balance.kind == LAW:
        return {name: Pattern.single(b) for name, b in _of_contact(weak, mechanism).items()}
    waves = Pattern(resonances(weak, mechanism, balance, frequencies), frequencies)
    if balance.kind == STILL:
        one, force = np.ones(weak.nodes.shape), weak.pressing(weak.nodes)
        return {"constant": Pattern.single(one), "force": Pattern.single(force), FREQUENCY: waves}
    state = weak.port_state(balance.row, weak.nodes)
    resting = np.where(state.resting, known_load(weak, mechanism, balance), 0.0)
    found = patterns_of_motion(state.moved, state.moving, state.way, resting, extent)
    found["constant"] = Pattern.single(np.full(weak.nodes.shape, balance.mass))
    force = weak.pressing(weak.nodes)
    return {**found, "force": Pattern.single(force), FREQUENCY: waves}


def patterns_of_motion(
    d: np.ndarray, v: np.ndarray, way: np.ndarray, resting: np.ndarray, extent: Extent
) -> dict[str, Pattern]:
    """Patterns of a displacement and its rate, shape (Q,) each.

    Args:
        d, v: displacement and rate, zero where they do not stand clear of their noise.
        way: sign of the rate, zero at rest.
        resting: known load where the body rests [N or N m], else zero.
        extent: of the displacement over all trials.
    """
    single = {
        "constant": np.ones(d.shape),
        "displacement": d,
        "displacement^3": d**3,
        "velocity": v,
        # what holds a resting body takes up the load on it, as friction does up to its limit
        "sign of velocity": way + (resting / extent.held if extent.held > 0.0 else 0.0),
        "velocity^2": v * np.abs(v),
        "direction of motion": np.abs(way),
    }
    shares = np.array(LARGE)
    large = np.array([extent.large(d, share) for share in shares])
    found = {name: Pattern.single(b) for name, b in single.items()}
    return {**found, "large displacement": Pattern(large, shares * max(extent.high, -extent.low))}


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


def resonances(weak: WeakTrial, mechanism: Mechanism, balance: Balance, frequencies: np.ndarray) -> np.ndarray:
    """What a hidden mass on a spring would push with, for each frequency [Hz], shape (F, Q).

    A body's known load over its mass, a(t), shakes the hidden mass; the force back is the hidden mass times its
    relative acceleration, a - Omega int a(s) e^(-zeta omega (t - s)) sin Omega (t - s) ds for small zeta, so that
    the pattern's coefficient is the hidden mass. A port that should stand still shows the integral itself.
    """
    if balance.kind == STILL:
        time, a = weak.shaking(mechanism, ("wrist",), 1.0)
    else:
        time, a = weak.shaking(mechanism, balance.name.split(" + "), balance.mass)
    if not np.any(a):
        return np.zeros((frequencies.size, weak.nodes.size))
    omega = 2.0 * np.pi * frequencies[:, None]
    pole = omega * (-LOSS + 1j)
    start = time[0]
    held = np.concatenate([np.zeros((omega.size, 1)), np.cumsum(np.exp(-pole * (time - start)) * a, axis=1)], axis=1)
    upto = np.searchsorted(time, weak.nodes, side="right")
    step = float(np.median(np.diff(time)))
    answer = (np.exp(pole * np.maximum(weak.nodes - start, 0.0)) * held[:, upto]).imag * step
    if balance.kind == STILL:
        return np.asarray(answer)
    return np.asarray(np.interp(weak.nodes, time, a, left=0.0, right=0.0) - omega * answer)


def known_load(weak: WeakTrial, mechanism: Mechanism, balance: Balance) -> np.ndarray:
    """What the model says acts on a balance at the nodes, along the smoothed motion, shape (Q,)."""
    names = balance.name.split(" + ")
    out = np.zeros(weak.nodes.shape)
    for force in mechanism.forces:
        factor = sum(mechanism.ports[force.port].get(c, 0.0) for c in names)
        linear = linear_coefficients(force.kernel, force.p) if factor and any(force.p) else None
        row = mechanism.ports[force.sense or force.port]
        if linear is not None and set(row) <= set(weak.observers.solution):
            out += factor * linear[0] * weak.port_state(dict(row), weak.nodes).moved
    time, load = weak.shaking(mechanism, names, 1.0)
    return np.asarray(out + np.interp(weak.nodes, time, load))


def extents(prepared: Mapping[str, Prepared]) -> dict[str, Extent]:
    """Balance -> how far it went over all trials (`Prepared` by id)."""
    out: dict[str, Extent] = {}
    for one in prepared.values():
        for name, balance in one.found.items():
            old = out.get(name, Extent(0.0, 0.0, 0.0))
            state = one.weak.port_state(balance.row, one.weak.nodes)
            held = 0.0
            if balance.kind == BODY and state.resting.any():
                held = float(np.abs(known_load(one.weak, one.mechanism, balance)[state.resting]).max())
            low, high = float(state.moved.min()), float(state.moved.max())
            out[name] = Extent(min(old.low, low), max(old.high, high), max(old.held, held))
    return out
