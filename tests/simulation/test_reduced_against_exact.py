"""The reduced backend against the exact solution of Eqs. 2 to 4 (matrix exponentials), friction and all re-contacts."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from spacerobot.effects.catalogue.coulomb_friction import CoulombFriction
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.rig import rig
from spacerobot.theory import table1
from spacerobot.theory.exact import solve


def gap(friction: float, hand_mass: float, *, spring: int = 0, stiffness: float = 1.0) -> tuple[float, float]:
    """Largest difference of positions and velocities over the largest value, wrist and target, to 0.6 s."""
    system = dataclasses.replace(
        table1.three_masses(table1.SPRINGS[spring], 9.0, damping="wrist"),
        hand_mass=hand_mass,
        guide_friction=friction,
    )
    mechanism = rig(
        {
            "hand.mass": hand_mass,
            "wrist.mass": system.wrist_mass,
            "wrist.stiffness": system.wrist_stiffness * stiffness,
            "wrist.damping": system.wrist_damping,
            "contact.stiffness": system.contact_stiffness,
            "contact.damping": system.contact_damping,
            "target.mass": system.target_mass,
        }
    )
    if friction:
        mechanism = CoulombFriction().apply(mechanism, "wrist", {"force_N": friction})
    run = simulate(mechanism, velocity={"target": 0.1}, end=0.6, tolerance=1e-12)
    times = np.linspace(0, 0.6, 301)
    taken, state = run.sample(times), solve(system, 0.1, duration=0.6).state(times)
    columns = [run.layout.coordinates.index(name) for name in ("wrist", "target")]
    position, velocity = taken.position[:, columns], taken.velocity[:, columns]
    return (
        float(np.abs(position - state[:, 1:3]).max() / np.abs(state[:, 1:3]).max()),
        float(np.abs(velocity - state[:, 4:6]).max() / np.abs(state[:, 4:6]).max()),
    )


@pytest.mark.parametrize("hand_mass", [math.inf, 8.0], ids=["locked", "free"])
@pytest.mark.parametrize("friction", [0.0, 0.8])
@pytest.mark.parametrize("spring", [0, 3])
def test_agrees_through_every_touch_and_stick(spring: int, friction: float, hand_mass: float) -> None:
    assert max(gap(friction, hand_mass, spring=spring)) < 1e-9


def test_a_spring_one_part_in_a_million_off_is_seen() -> None:
    assert max(gap(0.0, math.inf, stiffness=1 + 1e-6)) > 1e-8
