"""A URDF: entities, meshes, numbers, trees."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fuzz.target import Target
from fuzz.targets.scene import ROBOT
from spacerobot.model.library import load
from spacerobot.model.meshes import mesh_path
from spacerobot.model.validate import JOINT_TYPES

_RICH = b"""<?xml version="1.0" encoding="utf-8"?>
<robot name="good"><material name="m"><color rgba="1 0 0 1"/></material>
<link name="base"/>
<link name="arm"><inertial><origin xyz="0 0 0.1" rpy="0 0 0"/><mass value="2"/>
<inertia ixx="0.1" iyy="0.1" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="package://a/b.stl" scale="1 1 1"/></geometry><material name="m"/></visual>
<collision><geometry><box size="0.1 0.1 0.2"/></geometry></collision></link>
<link name="tip"/>
<joint name="turn" type="prismatic"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="10" velocity="2"/><dynamics damping="0.1" friction="0"/>
<mimic joint="turn" multiplier="1"/></joint>
<joint name="end" type="fixed"><parent link="arm"/><child link="tip"/></joint>
<transmission name="t"><joint name="turn"/><actuator name="m"><mechanicalReduction>50</mechanicalReduction>
<d:rotor_inertia xmlns:d="http://drake.mit.edu" value="1e-4"/></actuator></transmission></robot>
"""


def _prepare(folder: Path) -> Callable[[bytes], None]:
    file = folder / "robot.urdf"
    (folder / "a").mkdir()
    (folder / "a" / "b.stl").write_bytes(b"solid")

    def read(data: bytes) -> None:
        file.write_bytes(data)
        robot = load(file)
        assert robot.configuration().shape == (robot.model.nq,)
        assert len(robot.chain) <= robot.model.njoints
        mesh_path("package://a/b.stl", robot.mesh_dirs)

    return read


_WORDS = (
    *JOINT_TYPES, "<!DOCTYPE", "<!ENTITY", "SYSTEM", "file:///etc/passwd", "&x;", "<![CDATA[", "<?xml",
    "encoding=\"utf-16\"",
    "<link name=", "<joint name=", "<mimic", "<safety_controller", "<calibration", "<sphere radius=",
    "<cylinder", "<mesh",
    "package://", "../", "/etc/passwd", "http://", "nan", "inf", "1e308", "1e-308", "-0", "xmlns=", "wrist_slider",
    "wrist_mount", "wrist_tip", "\xef\xbb\xbf", "\x00", "<xi:include", "<!--", "-->",
)  # fmt: skip

TARGET = Target("urdf", _prepare, (_RICH, ROBOT.encode()), _WORDS, cases=60_000)
