from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed
from spacerobot.effects.mechanism import Mechanism
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.rig import rig
from spacerobot.simulation.sensors import read_channels

VALUES = {
    "wrist.mass": 0.7,
    "wrist.stiffness": 1000.0,
    "wrist.damping": 2.0,
    "wrist.equivalent_damping": 5.0,
    "contact.stiffness": 68000.0,
    "contact.damping": 60.0,
    "target.mass": 9.0,
}
NOISE = {"target.x": 1.5e-4, "wrist.x": 1.5e-4, "contact.force": 0.25, "target.yaw": 5e-4, "hand.x": 1.5e-4}
SPEEDS = (0.03, 0.06, 0.1, 0.15)
MASSES = (9.0, 23.2)
FREE_FLIGHT = 0.6  # s before the touch


@dataclass
class Rig:
    """What locating needs of a model, without a study."""

    believed: Believed
    base: dict[str, float] = field(default_factory=lambda: dict(VALUES))

    def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
        return rig(values)


def believed(conditions: Sequence[str]) -> Believed:
    sigma = {"wrist.stiffness": 0.01, "wrist.mass": 0.01, "wrist.equivalent_damping": 0.15, "target.mass": 0.002}
    return Believed(
        VALUES,
        {**sigma, "contact.stiffness": 0.03},
        {},
        tuple(conditions),
        {"contact.damping": 60.0},
        ("wrist.equivalent_damping",),
    )


def record(
    edit: Callable[[Mechanism], Mechanism] = lambda m: m,
    *,
    speeds: Sequence[float] = SPEEDS,
    masses: Sequence[float] = MASSES,
    channels: Sequence[Sequence[str]] = (("target.x", "wrist.x"), ("contact.force",)),
    noise: float = 1.0,
    seed: int = 0,
    values: Mapping[str, float] = VALUES,
) -> tuple[Rig, tuple[TrialData, ...]]:
    """A campaign simulated with an edited mechanism, and the rig as believed without the edit."""
    rng = np.random.default_rng(seed)
    trials = []
    for mass in masses:
        for speed in speeds:
            overrides = {"target.mass": mass}
            mechanism = edit(rig({**values, **overrides}))
            end = FREE_FLIGHT + 3.6 * np.sqrt((mass + 0.7) / 1000.0) + 0.9
            along = [n for n, c in mechanism.coordinates.items() if n == "target" or c.carrier == "target"]
            run = simulate(
                mechanism,
                position=dict.fromkeys(along, -speed * FREE_FLIGHT),
                velocity=dict.fromkeys(along, speed),
                end=end,
                tolerance=1e-8,
            )
            blocks = []
            for group in channels:
                time = np.arange(0.0, end, 1e-3 if "contact.force" in group else 1.0 / 120.0)
                read = np.array(list(read_channels(run, mechanism, group, time).values()))
                sigma = np.array([NOISE[c] for c in group])[:, None]
                noisy = read + noise * sigma * rng.normal(size=read.shape)
                blocks.append(Block(group[0], tuple(group), time, noisy, np.ones_like(noisy) / sigma))
            name = f"{mass:g}kg {speed:g}m/s"
            trials.append(TrialData(name, f"target.mass={mass:g}", overrides, tuple(blocks), 0.0, end))
    return Rig(believed(tuple(dict.fromkeys(t.condition for t in trials)))), tuple(trials)
