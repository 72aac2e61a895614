"""The balances of a trial: what the model says the forces should sum to, in weak form, from the measured motion.

A residual is predicted minus measured throughout: the forces that the model knows, less those that the measured
motion needs. A left-out force that pushes along +q shows as a negative residual, friction as a positive one while
the body moves along +q.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.locate.laws import (
    TARGET,
    WRIST,
    YAW,
    bulge,
    depth_of,
    linear_coefficients,
    push,
    slopes,
    values,
)
from spacerobot.diagnosis.locate.samples import Integral, total
from spacerobot.diagnosis.locate.weak_trial import WeakTrial
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force, Friction

CONTACT = "contact"
BODY, LAW, STILL = "body", "law", "still"


@dataclass(frozen=True, eq=False)
class Balance:
    """One balance of one trial. I test functions of the trial, of which `keep` count here.

    Attributes:
        name: whose: a coordinate, sums of them joined by " + ", "contact", or a port that should stand still.
        kind: BODY, LAW or STILL.
        unit: of the residual force ("N", "N m", or "m" for a port that should stand still).
        residual: predicted minus measured.
        keep: shape (I,) bool.
        row: the port whose displacement and rate the residual is held against, {coordinate: coefficient}.
        mass: kg, or kg m^2, that a uniform acceleration would act on.
    """

    name: str
    kind: str
    unit: str
    residual: Integral
    keep: np.ndarray
    row: dict[str, float]
    mass: float


def balances(weak: WeakTrial, mechanism: Mechanism) -> dict[str, Balance]:
    """Every balance that the trial's channels allow, by name, with the values of this mechanism."""
    found = [*_bodies(weak, mechanism), *_contact(weak, mechanism), *_still(weak, mechanism)]
    return {b.name: b for b in found}


def _bodies(weak: WeakTrial, mechanism: Mechanism) -> list[Balance]:
    forces = [f for f in mechanism.forces if any(f.p)]
    out = []
    for combination in _combinations(weak, mechanism):
        usable = all(
            all(_seen(weak, mechanism, p) for p in (f.sense or f.port, *f.beside))
            for f in forces
            if any(mechanism.ports[f.port].get(c) for c in combination)
        )
        driven = all(
            i.channel in weak.series
            for i in mechanism.inputs
            if any(mechanism.ports[i.port].get(c) for c in combination)
        )
        if usable and driven:
            out.append(_body(weak, mechanism, combination))
    return out


def _combinations(weak: WeakTrial, mechanism: Mechanism) -> list[dict[str, float]]:
    """Single coordinates; where an unmeasured contact pushes on two of them, their sum."""
    measured = [c for c in mechanism.coordinates if c in weak.observers.solution]
    if mechanism.contact is None or weak.force is not None:
        return [{c: 1.0} for c in measured]
    hit = set(push(mechanism, lambda t: np.zeros(t.shape), np.zeros(1)))
    out = [{c: 1.0} for c in measured if c not in hit]
    if {WRIST, TARGET} <= set(measured):
        out.append({WRIST: 1.0, TARGET: 1.0})
    return out


def _seen(weak: WeakTrial, mechanism: Mechanism, port: str) -> bool:
    return port in mechanism.ports and set(mechanism.ports[port]) <= set(weak.observers.solution)


def _body(weak: WeakTrial, mechanism: Mechanism, combination: dict[str, float]) -> Balance:
    count = weak.windows.count
    parts: list[Integral] = []

    def felt(port: str) -> float:
        """By how much a force along a port pushes on the combination."""
        return sum(x * mechanism.ports[port].get(c, 0.0) for c, x in combination.items())

    for c, x in combination.items():
        mass = mechanism.coordinates[c].mass
        parts.append(-x * mass * weak.coordinate(c, 2))
        for item in mechanism.fields:
            if item.body == c:
                uniform = np.full(weak.nodes.shape, x * mass * item.acceleration)
                parts.append(Integral(weak.integral(0, uniform)))
    for force in mechanism.forces:
        factor = felt(force.port)
        if factor and any(force.p):
            parts.append(factor * force_integral(weak, mechanism, force))
    for friction in mechanism.frictions:
        factor = felt(friction.port)
        if factor and friction.normal is None and _seen(weak, mechanism, friction.port):
            parts.append(factor * friction_integral(weak, mechanism, friction))
    for drive in mechanism.inputs:
        factor = felt(drive.port)
        if factor:
            parts.append(weak.drive(drive.channel, factor * drive.gain))
    if mechanism.contact is not None and weak.force is not None:
        for c, x in combination.items():
            if c in push(mechanism, weak.yaw, np.zeros(1)):
                parts.append(x * weak.contact_force(mechanism, c))
    name = " + ".join(combination)
    own = name if name in mechanism.ports else None
    row = dict(mechanism.ports[own]) if own and _seen(weak, mechanism, own) else dict(combination)
    if len(combination) > 1:
        row = {next(iter(combination)): 1.0}
    angular = all(mechanism.coordinates[c].angular for c in combination)
    mass = sum(mechanism.coordinates[c].mass for c in combination)
    keep = np.ones(count, dtype=bool)
    return Balance(name, BODY, "N m" if angular else "N", total(parts, count), keep, row, mass)


def force_integral(weak: WeakTrial, mechanism: Mechanism, force: Force) -> Integral:
    """int phi f dt of a force's law along the measured motion; linearised there for its noise."""
    row = dict(mechanism.ports[force.sense or force.port])
    linear = None if force.aux is not None else linear_coefficients(force.kernel, force.p)
    if linear is not None:
        by_d, by_v = linear
        parts = []
        for c, x in row.items():
            if by_d:
                parts.append(x * by_d * weak.coordinate(c, 0))
            if by_v:
                parts.append(-x * by_v * weak.coordinate(c, 1))
        return total(parts, weak.windows.count)
    state = weak.port_state(row, weak.nodes)
    aux = force.read_beside(lambda p: weak.port_state(dict(mechanism.ports[p]), weak.nodes).v)
    f = values(force.kernel, force.p, state.d, state.v, aux)
    slope_d, slope_v = slopes(force.kernel, force.p, state.d, state.v, aux)
    rest = f - slope_d * state.d - slope_v * state.v
    return Integral(weak.integral(0, rest)) + weak.modulated(row, slope_d, slope_v)


def friction_integral(weak: WeakTrial, mechanism: Mechanism, friction: Friction) -> Integral:
    """int phi f dt of a dry friction that the baseline knows, sliding as the smoothed motion has it."""
    state = weak.port_state(dict(mechanism.ports[friction.port]), weak.nodes)
    level = [friction.level(float(v), 0.0, float(d), friction.p) for v, d in zip(state.v, state.d, strict=True)]
    return Integral(weak.integral(0, -np.sign(state.v) * np.array(level)))


def _contact(weak: WeakTrial, mechanism: Mechanism) -> list[Balance]:
    contact = mechanism.contact
    if contact is None or weak.force is None or not {WRIST, TARGET} <= set(weak.observers.solution):
        return []
    keep = weak.pressed_windows()
    if not keep.any() or contact.p[0] == 0.0:
        return []
    row = {TARGET: 1.0, WRIST: -1.0}
    measured = weak.contact_force(mechanism, None)
    psi = weak.yaw(weak.nodes)
    bent = bulge(mechanism, psi)
    bent_rate = np.gradient(bent, weak.nodes)
    linear = linear_coefficients(contact.kernel, contact.p)
    if linear is not None:
        by_d, by_v = linear
        parts = [-1.0 * measured, Integral(weak.integral(0, -by_d * bent - by_v * bent_rate))]
        for c, x in row.items():
            parts += [-x * by_d * weak.coordinate(c, 0), x * by_v * weak.coordinate(c, 1)]
        law = total(parts, weak.windows.count)
    else:
        # the markers see a penetration only through noise; the force says where on the law the contact is
        d = depth_of(contact.kernel, contact.p)(weak.pressing(weak.nodes))
        v = np.gradient(d, weak.nodes)
        f = values(contact.kernel, contact.p, d, v)
        slope_d, slope_v = slopes(contact.kernel, contact.p, np.maximum(d, 1e-6), v)
        rest = -(f - slope_d * (d - bent) - slope_v * (v - bent_rate))
        law = Integral(weak.integral(0, rest)) + -1.0 * weak.modulated(row, slope_d, slope_v) + -1.0 * measured
    return [Balance(CONTACT, LAW, "N", law, keep, row, 0.0)]


def _still(weak: WeakTrial, mechanism: Mechanism) -> list[Balance]:
    """Ports that the model holds still and a channel shows."""
    out = []
    for channel, readout in mechanism.readouts.items():
        still = readout.kind == "position" and not mechanism.ports.get(readout.of, {"": 0.0})
        if still and channel in weak.series:
            series = weak.series[channel]
            weights = -readout.sign * weak.grid(series).weights(0)
            residual = Integral(weights @ series.value, {channel: weights})
            keep = np.ones(weak.windows.count, dtype=bool)
            out.append(Balance(readout.of, STILL, "m", residual, keep, {}, 0.0))
    return out


__all__ = ["BODY", "CONTACT", "LAW", "STILL", "YAW", "Balance", "balances", "force_integral"]
