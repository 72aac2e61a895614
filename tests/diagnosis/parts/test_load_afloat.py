"""A load on an arm whose base floats: the base gives way to it, and moves otherwise."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.diagnosis.machines.body_columns import BodyColumns
from spacerobot.diagnosis.machines.choose import some_models_for
from spacerobot.diagnosis.machines.platform import Platform
from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.effects.registry import effect
from spacerobot.model.library import load
from spacerobot.recordings.study import load_study
from tests.door.machines import MACHINES

GRAVITY = (0.0, 0.0, -9.80665)
JOINTS = ("near", "far")


def deck(mass: float = 0.0) -> str:
    """A platform with two links in the plane, the outer one with a load in its tip."""

    def link(name: str, mass: float, at: float, turns: float) -> str:
        inertia = f'<inertia ixx="0.01" iyy="{turns}" izz="{turns}" ixy="0" ixz="0" iyz="0"/>'
        return (
            f'<link name="{name}"><inertial><origin xyz="{at} 0 0"/><mass value="{mass}"/>{inertia}</inertial></link>'
        )

    def joint(name: str, parent: str, child: str, at: float) -> str:
        return (
            f'<joint name="{name}" type="revolute"><origin xyz="{at} 0 0"/><parent link="{parent}"/>'
            f'<child link="{child}"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="9" velocity="9"/></joint>'
        )

    tip = '<joint name="end" type="fixed"><origin xyz="0.35 0 0"/><parent link="lower"/><child link="tip"/></joint>'
    parts = link("base", 12.0, 0.0, 0.2) + link("upper", 1.2, 0.2, 0.016) + link("lower", 0.8, 0.175, 0.008)
    tiny = '<inertia ixx="1e-12" iyy="1e-12" izz="1e-12" ixy="0" ixz="0" iyz="0"/>'
    weight = f'<inertial><mass value="{mass + 1e-9}"/>{tiny}</inertial>'
    parts += f'<link name="tip">{weight}</link>'
    joints = joint("near", "base", "upper", 0.15) + joint("far", "upper", "lower", 0.4) + tip
    return f'<robot name="deck">{parts}{joints}</robot>'


def rigid(mass: float = 0.0) -> Rigid:
    return Rigid(load(deck(mass), floating=True), GRAVITY, JOINTS)


def motion(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    return (*(size * random.standard_normal((5, 2)) for size in (1.0, 2.0, 5.0)), random.standard_normal(5))


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(["upper", "tip"]), st.integers(0, 9))
def test_columns_are_how_torque_rises_with_a_body(seed: int, link: str, number: int) -> None:
    arm, step = rigid(), 1e-5 * np.eye(10)[number]
    columns = BodyColumns(load(deck(), floating=True), arm)
    joint, rows = columns.joint_of(link), motion(seed)
    more, less = (arm.with_bodies({joint: x}, np.zeros(3)).torque(*rows) for x in (step, -step))
    found = columns.along([link], [0, 1], *rows).reshape(5, 2, 10)[..., number]
    np.testing.assert_allclose(found, (more - less) / 2e-5, atol=1e-6 * max(1.0, float(np.abs(found).max())))


@pytest.mark.parametrize("mass", [0.1, 0.3])
def test_a_load_is_the_robot_that_has_it(mass: float) -> None:
    """And not in proportion to it: a base that gives way to twice the load gives way by less than twice as much."""
    arm, rows = rigid(), motion(7)
    columns = BodyColumns(load(deck(), floating=True), arm)
    body = columns.numbers("tip", np.zeros(3))
    joint = columns.joint_of("tip")
    plain, once, twice = (arm.with_bodies({joint: k * mass * body}, np.zeros(3)).torque(*rows) for k in (0, 1, 2))
    np.testing.assert_allclose(once, rigid(mass).torque(*rows), atol=1e-6)
    assert np.abs(twice - 2.0 * once + plain).max() > 1e-3


def test_the_base_moves_as_that_of_the_robot_that_has_it(tmp_path: Path) -> None:
    """A load where the rod's own centre is: the rod as much heavier."""
    folders = [MACHINES["platform"](tmp_path / name) for name in "ab"]
    path = folders[1] / "floater.urdf"
    text = path.read_text()
    assert text.count('<mass value="1.5"/>') == 1
    path.write_text(text.replace('<mass value="1.5"/>', '<mass value="1.9"/>'))
    shown = []
    for folder, mass in zip(folders, (0.4, 0.0), strict=True):
        (model,) = some_models_for(load_study(folder))
        assert isinstance(model, Platform)
        trial = model.trials[0]
        machine = model.mechanism(model.base, trial)
        (link,) = machine.links
        values = {"mass_kg": mass, "x_m": 0.3, "y_m": 0.0, "z_m": 0.0}
        loaded = effect("link_load").apply(machine, link, values) if mass else machine
        start = np.array([0.0, 0.01, 0.0, -0.02, 0.2, 0.05])
        shown.append(np.array([v[0] for v in model.predict(loaded, trial, start).blocks]))
    np.testing.assert_allclose(*shown, atol=1e-9)
