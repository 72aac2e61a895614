"""A carriage on a rail, its place and what drives it logged: the study's head and the robot."""

from __future__ import annotations

HEAD = """format = 1
title = "Axis"
[baseline]
robot = "axis.urdf"
base = "fixed"
joints = "free"
gravity = [0, 0, 0]
[streams.log]
time = "t"
[streams.log.channels]
q = { is = "joint.j.position" }
u = { is = "joint.j.torque", use = "input" }
"""


def axis_urdf(mass: float) -> str:
    """With a carriage of a mass [kg]."""
    return (
        f'<?xml version="1.0"?>\n<robot name="axis">{_link("rail", 10.0)}{_link("carriage", mass)}'
        '<joint name="j" type="prismatic"><parent link="rail"/><child link="carriage"/><axis xyz="1 0 0"/>'
        '<limit lower="-10" upper="10" effort="1e4" velocity="100"/></joint></robot>'
    )


def _link(name: str, mass: float) -> str:
    inertia = '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>'
    return f'<link name="{name}"><inertial><mass value="{mass}"/>{inertia}</inertial></link>'
