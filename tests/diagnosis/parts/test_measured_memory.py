"""A law with a memory read along a measured motion is the law that the simulator ran."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.diagnosis.machines.measured import port_forces
from spacerobot.effects.laws import SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Force
from spacerobot.effects.registry import effect
from spacerobot.simulation.reduced.run import simulate

LAWS = {
    "maxwell": {"stiffness_N_m": 30.0, "relaxation_s": 0.2},
    "bouc_wen": {"force_N": 0.4, "displacement_m": 5e-3},
    "dahl_friction": {"force_N": 0.4, "stiffness_N_m": 4e5},
}


@pytest.mark.parametrize("name", LAWS)
def test_read_along_its_own_motion(name: str) -> None:
    plain = Mechanism({"wrist": Coordinate("wrist", 2.0)}, {"wrist": {"wrist": 1.0}})
    machine = effect(name).apply(plain, "wrist", LAWS[name])
    swung = machine.with_force(Force("spring", "wrist", SPRING, (50.0,)))
    run = simulate(swung, position={"wrist": 0.05}, end=3.0)
    step = 1e-3
    t = np.arange(0.0, 2.9, step)
    taken = run.sample(t)
    found = port_forces(machine, {"wrist": taken.position[:, 0]}, {"wrist": taken.velocity[:, 0]}, step)["wrist"]
    apart = np.abs(found - taken.remembered[:, 0])
    turning = np.abs(taken.velocity[:, 0]) < 5e-3  # a bristle of a micrometre goes over between two samples
    assert np.quantile(apart[~turning], 0.99) < 2e-3 * np.abs(taken.remembered).max()
