"""Two joints of one arm: swinging freely, or driven with one log for both."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.machines.joint_log import kinematics
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.model.library import load
from spacerobot.recordings.study import Study, load_study
from tests.diagnosis.parts.helpers_two_links import GRAVITY, JOINTS, URDF, moved, swung, torque, written

NOISE = 1e-4
BELIEVED = "[baseline.sigma]\nlink.upper.mass = 0.02\nlink.lower.mass = 0.02\n"


def free(folder: Path, level: float) -> Study:
    """Let go of three times, with dry friction in the elbow."""
    time, random = np.arange(0.0, 8.0, 0.005), np.random.default_rng(5)

    def friction(v: np.ndarray) -> np.ndarray:
        return np.array([0.0, level * np.tanh(v[1] / 1e-3)])

    logs = []
    for release in ((1.0, 0.4), (-0.7, 1.2), (1.3, -0.5)):
        q = swung(release, time, friction) + NOISE * random.standard_normal((2, time.size))
        logs.append({"t": time, "q0": q[0], "q1": q[1]})
    return written(folder, logs, BELIEVED)


def driven(folder: Path, late: tuple[float, float], viscous: float = 0.0) -> Study:
    """Exciting motions whose encoders are late, each by so much [s]."""
    time, random = np.arange(0.0, 8.0, 0.005), np.random.default_rng(6)
    logs = []
    for seed in range(3):
        q, v, a = moved(time, seed)
        u = torque(q, v, a) + viscous * v
        u += 0.003 * np.std(u, axis=1, keepdims=True) * random.standard_normal(u.shape)
        seen = np.array([moved(time - late[k], seed)[0][k] for k in (0, 1)])
        seen += NOISE * random.standard_normal(seen.shape)
        logs.append({"t": time, "q0": seen[0], "q1": seen[1], "u0": u[0], "u1": u[1]})
    return written(folder, logs)


def slide(name: str, parent: str, axis: str) -> str:
    return f"""<link name="{name}_link"><inertial><mass value="2"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
      <joint name="{name}" type="prismatic"><parent link="{parent}"/><child link="{name}_link"/>
      <axis xyz="{axis}"/><limit lower="-2" upper="2" effort="90" velocity="9"/></joint>"""


GANTRY = f"""<robot name="gantry"><link name="stand"/>{slide("shoulder", "stand", "1 0 0")}
  {slide("elbow", "shoulder_link", "0 1 0")}{slide("hoist", "elbow_link", "0 0 1")}</robot>"""


def gantry(folder: Path, stiffness: float) -> Study:
    """Two slides that lie level; a hose pulls the second one back."""
    time, random = np.arange(0.0, 8.0, 0.005), np.random.default_rng(7)
    logs = []
    for seed in range(3):
        q, _, a = moved(time, seed)
        u = np.array([[6.0], [4.0]]) * a + np.array([[0.0], [stiffness]]) * q
        u += 0.003 * np.std(u, axis=1, keepdims=True) * random.standard_normal(u.shape)
        q = q + NOISE * random.standard_normal(q.shape)
        logs.append({"t": time, "q0": q[0], "q1": q[1], "u0": u[0], "u1": u[1]})
    path = written(folder, logs).path
    (folder / "arm.urdf").write_text(GANTRY)
    return load_study(path)


@pytest.mark.slow
def test_a_spring_is_one_where_no_weight_could_be_meant(tmp_path: Path) -> None:
    """It was a stop that the joint never left, with a constant force learned beside it."""
    answer = diagnose(gantry(tmp_path, 5.0))
    parts = {p.name: [(s.effect.name, s.where) for s in p.chosen.sites] for p in answer.parts}
    assert parts == {"shoulder": [], "elbow": [("joint_spring", "joint.elbow")]}


def test_a_spring_is_not_sought_where_a_heavier_link_does_the_same(tmp_path: Path) -> None:
    for model in models_for(driven(tmp_path, (0.0, 0.0))):
        assert "joint_spring" not in {s.effect.name for s in model.sites()}


@pytest.mark.parametrize(
    ("robot", "gravity", "level"),
    [
        (GANTRY, (0.0, 0.0, -9.81), ["shoulder", "elbow"]),
        (GANTRY, (0.0, -9.81, 0.0), ["shoulder", "hoist"]),
        ("pa10", (0.0, 0.0, -9.81), []),
    ],
)
def test_what_slides_level(robot: str, gravity: tuple[float, float, float], level: list[str]) -> None:
    built, random = load(robot), np.random.default_rng(1)
    found = Rigid(built, gravity, built.chain).level(random.uniform(-1.0, 1.0, (20, len(built.chain))))
    assert [j for j, so in zip(built.chain, found, strict=True) if so] == level


def test_pinocchio_asks_for_the_textbook_s_torques() -> None:
    q, v, a = moved(np.linspace(0.0, 5.0, 60), 1)
    arm = Rigid(load(URDF), (0.0, 0.0, -GRAVITY), JOINTS)
    np.testing.assert_allclose(arm.torque(q.T, v.T, a.T).T, torque(q, v, a), atol=1e-12)


@pytest.fixture(scope="module")
def swinging(tmp_path_factory: pytest.TempPathFactory) -> tuple[InverseDynamics, ...]:
    models = models_for(free(tmp_path_factory.mktemp("free"), 0.02))
    return tuple(m for m in models if isinstance(m, InverseDynamics))


def left(model: InverseDynamics, heavier: Mapping[str, float]) -> np.ndarray:
    """What the first piece's balance asks for, of links so many times as heavy."""
    trial = model.trials[0]
    mechanism = model.mechanism({n: v * heavier.get(n, 1.0) for n, v in model.base.items()}, trial)
    return model.predict(mechanism, trial, np.zeros(0)).blocks[0]


@settings(deadline=None, max_examples=20)
@given(st.floats(-2.0, 2.0))
def test_where_nothing_drives_a_joint_heavier_and_lighter_arms_swing_alike(
    swinging: tuple[InverseDynamics, ...], power: float
) -> None:
    """All links so many times as heavy leave the same over; one of them alone does not."""
    for model in swinging:
        plain = left(model, {})
        alike = left(model, {n: 10.0**power for n in model.base if n.startswith("link.")})
        np.testing.assert_allclose(alike, plain, rtol=1e-6, atol=1e-9 * np.abs(plain).max())
        if model.name == "shoulder":
            assert np.abs(left(model, {"link.lower.mass": 2.0}) - plain).max() > np.abs(plain).max()


@pytest.mark.slow
def test_friction_in_a_joint_that_swings_is_named_and_no_link_is_light(tmp_path: Path) -> None:
    verdict = diagnose(free(tmp_path, 0.02), jobs=1).verdict
    (effect,) = verdict["effects"]
    assert (effect["effect"], effect["where"]) == ("coulomb_friction", "joint.elbow")
    assert effect["parameters"]["force_Nm"]["value"] == pytest.approx(0.02, rel=0.03)
    assert all(abs(m["in_sigmas"]) < 1.0 for m in verdict["moved"].values())


@pytest.mark.parametrize("step", [0.01, 0.005])
def test_a_smoothed_motion_asks_for_the_smoothed_torque(step: float) -> None:
    """Of an arm that whirls; what it asks for where it seems to be is off by a hundredth of its weight."""
    time = np.arange(0.0, 6.0, step)
    q, v, a = (np.array([x, x]) for x in (9.0 * time + np.sin(4.0 * time), 9.0 + 4.0 * np.cos(4.0 * time), 0.0 * time))
    a = a - 16.0 * np.sin(4.0 * time)
    true = torque(q, v, a)
    values = {f"joint.{j}.{w}": x for k, j in enumerate(JOINTS) for w, x in (("position", q[k]), ("torque", true[k]))}
    grid = Grid(time, step, values, np.ones(time.size, dtype=bool))
    log = kinematics(grid, JOINTS, 5)
    arm = Rigid(load(URDF), (0.0, 0.0, -GRAVITY), JOINTS)
    inner = slice(10, -10)
    plain = arm.torque(log.position, log.velocity, log.acceleration)
    for thin in (1, 2) if step < 0.01 else (1,):
        told = log if thin == 1 else kinematics(grid, JOINTS, 6)
        rigid = told.thinned(thin, arm, ()).rigid[inner]
        off = np.abs(rigid - told.torque[::thin][inner]).max()
        assert off < 0.15 * np.abs(plain - log.torque)[inner].max()


@pytest.mark.slow
def test_encoders_that_are_late_are_told_at_both_joints_however_many_processes_there_are(tmp_path: Path) -> None:
    study = driven(tmp_path, (0.03, 0.03), viscous=0.1)
    verdict = diagnose(study, jobs=1).verdict
    told: list[str] = []
    watched = diagnose(study, jobs=2, report=lambda what, done, total: told.append(what))  # a process for each joint
    assert told
    aside = watched.verdict
    assert {k: v for k, v in aside.items() if k != "seconds"} == {k: v for k, v in verdict.items() if k != "seconds"}
    found = {(e["effect"], e["part"]): next(iter(e["parameters"].values()))["value"] for e in verdict["effects"]}
    assert set(found) == {(e, j) for e in ("time_offset", "viscous_friction") for j in JOINTS}
    for joint in JOINTS:
        assert found["time_offset", joint] == pytest.approx(-0.03, rel=0.03)
        assert found["viscous_friction", joint] == pytest.approx(0.1, rel=0.03)


@pytest.mark.slow
def test_what_one_joint_alone_takes_for_a_late_clock_is_none(tmp_path: Path) -> None:
    """One log has one clock: the elbow's encoder is late by itself, and the shoulder feels no delay."""
    verdict = diagnose(driven(tmp_path, (0.0, 0.03)), jobs=1).verdict
    assert all(e["effect"] != "time_offset" for p in verdict["parts"] for e in p["effects"])
