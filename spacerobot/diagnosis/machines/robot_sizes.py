"""What is typical at the joints and the base of a robot that a target hits, by what it does as believed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spacerobot.diagnosis.machines.contract import Nuisance
from spacerobot.diagnosis.machines.robot_channels import of_robot
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.sizes import Sizes
from spacerobot.support.errors import SimulationError

STILL = 1e-3
"""Share of the largest displacement of its kind that a place stays within where it does not move and nothing reads it:
what noise in how the trials start leaves of the joints that would turn an arm out of the plane in which it stands."""

READ = 2.0
"""Rms of a channel about its mean, in its noise, above which it is read to move."""

SHOWN = 0.2
"""Displacement as believed, in the noise of its channel, that its hundreds of readings show together."""


def sizes_at_places(model: RigModel) -> dict[str, Sizes]:
    """Place -> what is typical there, of joints and of the base; places that do not move are not among them.

    Of what a free joint does, the force is what its inertia takes; of one on a servo, what its spring does.

    Args:
        model: the rig, with its trials.
    """
    seen: dict[str, list[tuple[float, float, float]]] = {}  # mean squares of displacement and rate, and the force
    believed = hypothesis(model.believed, [])
    for trial in model.trials:
        mechanism = model.trial_mechanism(believed, believed.start(), trial)
        initial = np.array([0.0 if _faint(n) else n.guess for n in model.nuisances(trial)])
        try:
            run = model.predict(mechanism, trial, initial).run
        except SimulationError:
            continue
        position, rate = run.states(np.linspace(trial.start, trial.end, 200))
        for port in mechanism.ports:
            if not (port.startswith("joint.") or port == "base" or port.startswith("base.")):
                continue
            d, v = run.port(port, position), run.port(port, rate)
            seen.setdefault(port, []).append((float(np.var(d)), float(np.mean(v * v)), _force(mechanism, port, d, v)))
    found: dict[str, Sizes] = {}
    for port, rows in seen.items():
        length, speed, force = np.sqrt(np.mean(np.square(np.array(rows) ** [0.5, 0.5, 1.0]), axis=0)).tolist()
        if length > 0.0 and speed > 0.0 and force > 0.0:
            found[port] = Sizes(force, length, length / speed)
    return {port: size for port, size in found.items() if _moves(port, size, found, model.trials)}


def _faint(nuisance: Nuisance) -> bool:
    """A drift of joints or base that readings do not show is none."""
    return nuisance.rate and of_robot(nuisance.coordinate) and abs(nuisance.guess) < nuisance.scale


def _force(mechanism: Mechanism, port: str, d: np.ndarray, v: np.ndarray) -> float:
    """What moves a place as it moves: its inertia's share and that of a spring on it, whichever is more."""
    rates = mechanism.ports[port]
    mobility = sum(r * r / mechanism.coordinates[name].mass for name, r in rates.items())
    spring = sum(f.p[0] for f in mechanism.forces if f.port == port and f.role == "spring")
    length, square = float(np.std(d)), float(np.mean(v * v))
    inertia = square / (mobility * length) if mobility > 0.0 and length > 0.0 else 0.0  # m v^2 / d
    return max(inertia, spring * length)


def _moves(port: str, size: Sizes, found: dict[str, Sizes], trials: Sequence[TrialData]) -> bool:
    """As it is read, or as believed; where nothing reads it, beside its like."""
    readings = [t.channel(f"{port}.position") for t in trials if f"{port}.position" in t.channels]
    if readings:
        return any(r > READ or size.length * w > SHOWN for r, w in map(_spread, readings))
    kind = "joint." if port.startswith("joint.") else "base"
    return size.length > STILL * max(s.length for name, s in found.items() if name.startswith(kind))


def _spread(channel: tuple[np.ndarray, np.ndarray, np.ndarray]) -> tuple[float, float]:
    """Rms of readings about their mean, in their noise, and the inverse of that noise."""
    _, value, weight = channel
    good = weight > 0.0
    if not good.any():
        return 0.0, 0.0
    usual = float(np.median(weight[good]))
    return float(np.std(value[good])) * usual, usual
