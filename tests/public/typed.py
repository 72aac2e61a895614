"""What a type checker must see through `import spacerobot`: never run, only checked by `mypy`.

A line with a mark at its end holds a mistake that must be found; `test_names.py` takes the marks away and looks.
"""

from __future__ import annotations

from typing import assert_type

import numpy as np

import spacerobot
from spacerobot import EffectiveMass, Robot, Scene, Study, Trajectory

robot = spacerobot.load("pa10_wrist")
assert_type(robot, Robot)
assert_type(spacerobot.effective_mass(robot, np.zeros(7), [1.0, 0.0, 0.0]), EffectiveMass)
assert_type(spacerobot.simulate(Scene(robot)), Trajectory)
assert_type(spacerobot.load_study("guide-friction"), Study)
Scene(wrist=spacerobot.Wrist(stiffness=530.0), target=spacerobot.Target(mass=9.0))

Scene(wrst=3)  # type: ignore[call-arg]
Scene(wrist=3)  # type: ignore[arg-type]
spacerobot.simulate("pa10_wrist")  # type: ignore[arg-type]
spacerobot.effective_mas(robot)  # type: ignore[attr-defined]
