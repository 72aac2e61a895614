"""What is typical at the joints and the base of a robot that a target hits, by what it does as believed."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from spacerobot.diagnosis.machines.robot_channels import of_robot
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.sizes import Sizes
from spacerobot.support.errors import SimulationError

STILL = 1e-3
"""Share of the largest displacement of its kind that a place stays within where it does not move: what the pose of an
arm that stands in a plane, written to six digits, leaves of the joints that would turn it out of it."""

READ = 2.0
"""Rms of a channel about its mean, in its noise, within which it does not move either."""


def sizes_at_places(
    model: RigModel, simulated: Callable[[TrialData], tuple[Mechanism, np.ndarray]], trials: Sequence[TrialData]
) -> dict[str, Sizes]:
    """Place -> what is typical there, of joints and of the base; places that do not move are not among them.

    Of what a free joint does, the force is what its inertia takes; of one on a servo, what its spring does.

    Args:
        model: the rig.
        simulated: of a trial, its mechanism as believed and its own values.
        trials: to look at.
    """
    seen: dict[str, list[tuple[float, float, float]]] = {}  # mean squares of displacement and rate, and the force
    for trial in trials:
        mechanism, initial = simulated(trial)
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
    return {port: size for port, size in found.items() if _moves(port, size, found, trials)}


def _force(mechanism: Mechanism, port: str, d: np.ndarray, v: np.ndarray) -> float:
    """What moves a place as it moves: its inertia's share and that of a spring on it, whichever is more."""
    rates = mechanism.ports[port]
    mobility = sum(r * r / mechanism.coordinates[name].mass for name, r in rates.items())
    spring = sum(f.p[0] for f in mechanism.forces if f.port == port and f.role == "spring")
    length, square = float(np.std(d)), float(np.mean(v * v))
    inertia = square / (mobility * length) if mobility > 0.0 and length > 0.0 else 0.0  # m v^2 / d
    return max(inertia, spring * length)


def _moves(port: str, size: Sizes, found: dict[str, Sizes], trials: Sequence[TrialData]) -> bool:
    kind = "joint." if port.startswith("joint.") else "base"
    largest = max(s.length for name, s in found.items() if name.startswith(kind))
    return size.length > STILL * largest or any(_read(f"{port}.position", t) for t in trials)


def _read(channel: str, trial: TrialData) -> bool:
    """Whether a recording shows that what a channel reads moves."""
    if channel not in trial.channels or not of_robot(channel):
        return False
    _, value, weight = trial.channel(channel)
    good = weight > 0.0
    return bool(good.any() and np.std(value[good]) * float(np.median(weight[good])) > READ)
