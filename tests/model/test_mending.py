"""Impossible inertias of published URDFs are moved to the nearest that a body can have."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.cli.main import main
from spacerobot.model.inertia import inertia_fault
from spacerobot.model.library import load
from spacerobot.model.mending import nearest_possible
from spacerobot.recordings.rig_robot import study_robot
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError

MOMENTS = st.tuples(*[st.floats(-0.5, 2.0) for _ in range(3)])
SEEDS = st.integers(0, 2**20)


def turned(moments: tuple[float, ...], seed: int) -> np.ndarray:
    axes = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return (axes * np.array(moments)) @ axes.T


@given(MOMENTS, SEEDS, st.floats(0.01, 10))
def test_what_is_mended_can_exist(moments: tuple[float, ...], seed: int, mass: float) -> None:
    assert inertia_fault(mass, nearest_possible(mass, turned(moments, seed))) is None


@given(st.tuples(*[st.floats(0.01, 1.0) for _ in range(3)]), SEEDS)
def test_what_can_exist_stays(squares: tuple[float, ...], seed: int) -> None:
    a, b, c = squares  # moments of a body with these second moments of mass
    inertia = turned((b + c, a + c, a + b), seed)
    np.testing.assert_allclose(nearest_possible(1.0, inertia), inertia, rtol=1e-9, atol=1e-12)


@given(
    st.tuples(*[st.floats(0.05, 2.0) for _ in range(3)]), st.tuples(*[st.floats(0.05, 1.0) for _ in range(3)]), SEEDS
)
def test_no_possible_inertia_is_nearer(moments: tuple[float, ...], others: tuple[float, ...], seed: int) -> None:
    inertia = turned(moments, seed)
    a, b, c = others
    rival = turned((b + c, a + c, a + b), seed + 1)
    mended = nearest_possible(1.0, inertia)
    assert np.linalg.norm(mended - inertia) <= np.linalg.norm(rival - inertia) + 1e-9


URDF = """<robot name="r"><link name="base"/>
<link name="arm"><inertial><origin xyz="0.1 0 0.2" rpy="0.3 -0.2 0.9"/><mass value="2"/>
<inertia ixx="{0}" iyy="{1}" izz="{2}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="plate"><inertial><mass value="{3}"/>
<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="10" velocity="1"/></joint>
<joint name="f" type="fixed"><parent link="arm"/><child link="plate"/></joint></robot>"""


def test_a_robot_is_mended_only_where_asked_and_says_so() -> None:
    text = URDF.format(0.0, 0.0, 0.0, 0)
    with pytest.raises(InputError, match="cannot exist"):
        load(text)
    robot = load(text, mend=True)
    assert "arm" in robot.mended[0]
    assert load(robot.urdf).mended == ()  # the mended URDF is a possible one
    body = robot.model.inertias[1]
    np.testing.assert_allclose(body.inertia, nearest_possible(2.0, np.zeros((3, 3))), rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("plate", [0, 0.5])
def test_the_whole_body_that_moves_is_moved_least(plate: float) -> None:
    text = URDF.format(1.0, 0.2, 0.3, plate)
    body = load(text, mend=True).model.inertias[1]
    assert inertia_fault(body.mass, body.inertia) is None
    assert body.mass == 2 + plate
    low, middle, high = np.linalg.eigvalsh(body.inertia)
    if plate == 0:
        np.testing.assert_allclose([low, middle, high], [0.2 + 1 / 6, 0.3 + 1 / 6, 1 - 1 / 6], rtol=1e-9)


def test_a_possible_robot_is_left_alone() -> None:
    assert load("pa10", mend=True).mended == ()
    assert load("pa10", mend=True).urdf == load("pa10").urdf


def test_a_study_states_a_links_inertia(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(URDF.format(0.0, 0.0, 0.0, 0))
    (tmp_path / "log.csv").write_text("0,1\n1,2\n2,3\n")
    study = """format = 1
[baseline]
robot = "r.urdf"
[baseline.link.arm]
inertia = [0.03, 0.02, 0.04]
[streams.log]
time = 0
[streams.log.channels]
1 = { is = "joint.j.position" }
[[trials]]
id = "01"
log = "log.csv"
"""
    (tmp_path / "study.toml").write_text(study)
    robot = study_robot(load_study(tmp_path))
    assert robot.mended == ()
    np.testing.assert_allclose(np.linalg.eigvalsh(robot.model.inertias[1].inertia), [0.02, 0.03, 0.04])
    (tmp_path / "study.toml").write_text(study.replace("link.arm", "link.amr"))
    with pytest.raises(InputError, match="arm"):
        study_robot(load_study(tmp_path))


def test_who_checks_and_who_diagnoses_are_told_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "r.urdf").write_text(URDF.format(0.0, 0.0, 0.0, 0))
    (tmp_path / "log.csv").write_text("".join(f"{0.01 * n:.2f},{n % 7}\n" for n in range(60)))
    (tmp_path / "study.toml").write_text("""format = 1
[baseline]
robot = "r.urdf"
[streams.log]
time = 0
[streams.log.channels]
1 = { is = "joint.j.position" }
[[trials]]
id = "01"
log = "log.csv"
""")
    main(["study", "check", str(tmp_path), "--json"])
    told = [w for w in json.loads(capsys.readouterr().out)["warnings"] if w.startswith("robot: ")]
    assert told
    main(["diagnose", str(tmp_path)])  # which refuses this study; what it found of the robot is said before
    said = capsys.readouterr().err
    assert all(warning in said for warning in told)
