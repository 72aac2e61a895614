"""A scene file."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable
from pathlib import Path

from fuzz.target import Target
from spacerobot.effects.registry import all_effects
from spacerobot.model.spacecraft import SpacecraftSpec
from spacerobot.simulation import scene_toml
from spacerobot.simulation.parts import ContactLaw, Servo, Wrist
from spacerobot.simulation.parts import Target as Body
from spacerobot.simulation.scene_file import read_scene, scene_from_text

GOOD = b"""format = 1
robot = "robot.urdf"
base = "fixed"
joints = "locked"
pose = [0.1]
approach = [1, 0, 0]
gravity = [0, 0, 0]
backend = "reduced"
[wrist]
mass = 0.7
stiffness = 530
damping = 1.4
[contact]
stiffness = 68000
damping = 40
[target]
mass = 9.0
speed = 0.07
gap = 0.01
spin = [0, 0, 0.1]
[[effects]]
effect = "coulomb_friction"
where = "wrist"
parameters = { force_N = 0.4 }
"""

FREE = b"""robot = "robot.urdf"
base = "free"
joints = "servo"
tip = "tip"
duration = 1
title = "x"
backend = "multibody"
[servo]
stiffness = 1e5
damping = 10
[spacecraft]
mass = 100
[chaser]
hand_speed = 0.01
[target]
inertia = [1, 1, 1]
contact_point = [0.1, 0.02]
attitude = [0.1, 0, 0]
"""

ROBOT = """<robot name="good"><link name="base"/>
<link name="arm"><inertial><origin xyz="0 0 0.1"/><mass value="2"/>
<inertia ixx="0.1" iyy="0.1" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="tip"/>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="10" velocity="2"/></joint>
<joint name="end" type="fixed"><parent link="arm"/><child link="tip"/><origin xyz="0 0 0.3"/></joint></robot>"""


def _prepare(folder: Path) -> Callable[[bytes], None]:
    (folder / "robot.urdf").write_text(ROBOT)
    warnings.simplefilter("ignore")
    file = folder / "scene.toml"

    def read(data: bytes) -> None:
        file.write_bytes(data)
        scene = read_scene(file)
        again = scene_from_text(scene.to_toml(), folder=folder)  # what was read can be written and read again
        assert again.to_toml() == scene.to_toml()

    return read


_TABLES = (Wrist, ContactLaw, Body, Servo, SpacecraftSpec)
_WORDS = (
    *scene_toml._TOP, *(f.name for kind in _TABLES for f in dataclasses.fields(kind)), *all_effects(),
    "target.y", "arm",
    *(p.name for effect in all_effects().values() for p in effect.parameters), "nan", "inf", "1e12", "1e-12", "1e300",
    "hertz", "kelvin_voigt", "hunt_crossley", "multibody", "servo", "joint.turn", "../../x.urdf", "/etc/passwd", "true",
)  # fmt: skip

TARGET = Target("scene", _prepare, (GOOD, FREE), _WORDS, cases=15_000)
