"""Robots, poses and directions that the dynamics tests share."""

from __future__ import annotations

import functools

import numpy as np

from spacerobot.dynamics.regime import Regime
from spacerobot.model.library import load
from spacerobot.model.robot import Robot

DEFAULT = np.deg2rad([0.0, 45.0, 0.0, 90.0, 0.0, -45.0, 0.0])

REGIMES = [Regime(base, joints, slider) for base in ("fixed", "free") for joints in ("free", "locked")
           for slider in ("free", "locked")]  # fmt: skip


@functools.cache
def robot(name: str, floating: bool = False) -> Robot:
    return load(name, floating=True) if floating else load(name)


def poses(model: Robot, count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-2.5, 2.5, (count, len(model.chain)))


def directions(count: int, seed: int = 1) -> np.ndarray:
    n = np.random.default_rng(seed).normal(size=(count, 3))
    return n / np.linalg.norm(n, axis=1)[:, None]


def with_base(model: Robot, configuration: np.ndarray, quaternion: np.ndarray, position: np.ndarray) -> np.ndarray:
    """The configuration with the base at a position [m] and attitude (x, y, z, w)."""
    moved = configuration.copy()
    start = model.model.joints[1].idx_q
    moved[start : start + 3] = position
    moved[start + 3 : start + 7] = quaternion / np.linalg.norm(quaternion)
    return moved


def turn(quaternion: np.ndarray) -> np.ndarray:
    """Rotation matrix of (x, y, z, w)."""
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


ROD = """<robot name="rod">
  <link name="base"/>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <link name="rod"><inertial><origin xyz="0.2 0 0"/><mass value="3"/>
    <inertia ixx="0.04" iyy="0.05" izz="0.06" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="end" type="fixed"><parent link="rod"/><child link="tip"/><origin xyz="0.5 0 0"/></joint>
  <link name="tip"/>
</robot>"""
"""A rod on a hinge: about the hinge 0.06 + 3 x 0.2^2 = 0.18 kg m^2; its tip is 0.5 m out."""

CART = """<robot name="cart">
  <link name="ship"><inertial><mass value="7"/>
    <inertia ixx="2" iyy="3" izz="4" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="rail" type="prismatic"><parent link="ship"/><child link="cart"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <link name="cart"><inertial><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="end" type="fixed"><parent link="cart"/><child link="tip"/><origin xyz="0.5 0 0"/></joint>
  <link name="tip"/>
</robot>"""
"""A cart on a rail through the centre of a ship: along the rail 2 kg free, 9 kg locked."""
