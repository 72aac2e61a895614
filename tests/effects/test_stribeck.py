"""Friction that falls with speed, and what only looks like it."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.effects.catalogue.stribeck_friction import level
from spacerobot.effects.registry import effect
from spacerobot.effects.sizes import Sizes

SPEED = 0.08
SIZES = Sizes(force=1.0, length=SPEED * 0.05, time=0.05)


def plausible(name: str, velocity: float) -> bool:
    values = {"static_force_N": 0.5, "coulomb_force_N": 0.2, "velocity_m_s": velocity}
    bristles = {} if name == "stribeck_friction" else {"bristle_stiffness_N_m": 3e3, "bristle_damping_Ns_m": 1.0}
    return effect(name).implausible({**values, **bristles}, SIZES) == ""


def straight_share(velocity: float) -> float:
    """Of what a Stribeck law changes over the speeds of a motion (to twice the typical one), the share that a damper
    beside dry friction explains."""
    speeds = np.linspace(0.0, 2.0 * SPEED, 200)
    force = np.array([level(v, 1.0, 0.0, (0.5, 0.2, velocity)) for v in speeds])
    left = force - np.polyval(np.polyfit(speeds, force, 1), speeds)
    return 1.0 - float(np.var(left) / np.var(force))


@pytest.mark.parametrize("name", ["stribeck_friction", "lugre_friction"])
@pytest.mark.parametrize("velocity", [0.01, 0.025, 0.04, 0.05, 0.1, 0.2, 1.0])
def test_a_fall_that_no_damper_makes_is_stribecks(name: str, velocity: float) -> None:
    """A guide whose friction has fallen by half the typical speed is one; at the whole of it a damper is as good."""
    assert plausible(name, velocity) == (straight_share(velocity) < 0.9)
