"""Logs of motors: what `[gears]` makes of them is what the joints do, coupled wrists too."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.recordings.draft import draft_study
from spacerobot.recordings.study import Study, load_study
from spacerobot.recordings.table import Floats
from spacerobot.support.errors import InputError

RATIO = np.diag([32.0, 45.0, -48.0])
COUPLED = RATIO + np.array([[0, 0, 0], [0, 0, 32.0], [0, 0, 0]])
STUDY = """format = 1
[baseline]
robot = "pa10"
[gears]
{gears}
[streams.log]
time = "t"
[streams.log.channels]
{channels}
[[trials]]
id = "1"
log = "log.csv"
"""


def log(folder: Path, ratio: Floats, constant: float) -> tuple[Floats, Floats]:
    """Write what three motors log; the joints' angles and torques."""
    t = np.arange(0, 2, 0.01)
    q = np.sin(np.outer(t, [1.0, 1.5, 2.0]))
    torque = np.cos(np.outer(t, [2.0, 1.0, 3.0]))
    motors, drive = q @ ratio.T, np.linalg.solve(ratio.T, torque.T).T
    head = ",".join(["t", *(f"q{j}" for j in (1, 2, 3)), *(f"i{j}" for j in (1, 2, 3))])
    np.savetxt(
        folder / "log.csv", np.column_stack([t, motors, drive / constant]), "%.12g", ",", header=head, comments=""
    )
    return q, torque


def study(folder: Path, ratio: Floats, gears: str = "", sigma: str = "") -> Study:
    rows = ", ".join(str(list(map(float, r))) for r in ratio)
    names = 'streams = ["log"]\njoints = ["a", "b", "c"]'
    lines = [f'q{k} = {{ is = "joint.{j}.position"{sigma} }}' for k, j in enumerate("abc", 1)]
    lines += [f'i{k} = {{ is = "joint.{j}.current", use = "input" }}' for k, j in enumerate("abc", 1)]
    text = STUDY.format(
        gears=gears or f"{names}\nratio = [{rows}]\ntorque_per_ampere = 0.07", channels="\n".join(lines)
    )
    (folder / "study.toml").write_text(text)
    return load_study(folder)


@settings(max_examples=20, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(st.floats(-60, 60), min_size=9, max_size=9))
def test_joints_come_back_from_their_motors(tmp_path: Path, numbers: list[float]) -> None:
    ratio = COUPLED + 0.2 * np.array(numbers).reshape(3, 3)
    if np.linalg.cond(ratio) > 1e3 or np.abs(np.diag(np.linalg.inv(ratio))).min() < 1e-4:
        return
    q, torque = log(tmp_path, ratio, 0.07)
    recording = study(tmp_path, ratio).recording("1")
    for k, joint in enumerate("abc"):
        assert recording[f"joint.{joint}.position"].value == pytest.approx(q[:, k], abs=1e-8)
        assert recording[f"joint.{joint}.torque"].value == pytest.approx(torque[:, k], abs=1e-8)
        assert f"joint.{joint}.current" not in recording


def test_noise_goes_through_the_gears(tmp_path: Path) -> None:
    log(tmp_path, COUPLED, 0.07)
    recording = study(tmp_path, COUPLED, sigma=", sigma = 0.01").recording("1")
    inverse = np.linalg.inv(COUPLED)
    for k, joint in enumerate("abc"):
        assert recording[f"joint.{joint}.position"].sigma == pytest.approx(0.01 * np.linalg.norm(inverse[k]))


@pytest.mark.parametrize(
    ("gears", "said"),
    [
        ('streams = ["log"]\njoints = ["a", "b"]\nratio = [1]', "2"),
        ('streams = ["log"]\njoints = ["a", "b"]\nratio = [[1, 2], [2, 4]]', "undone"),
        ('streams = ["lag"]\njoints = ["a"]\nratio = [1]', "log"),
        ('streams = ["log"]\nratio = [1]', "joints"),
        ('streams = ["log"]\njoints = ["a", "d"]\nratio = [[1, 1], [0, 1]]', "not logged"),
    ],
)
def test_refused(tmp_path: Path, gears: str, said: str) -> None:
    log(tmp_path, RATIO, 1.0)
    with pytest.raises(InputError, match=said):
        study(tmp_path, RATIO, gears)


def test_a_draft_asks_where_motors_are_logged(tmp_path: Path) -> None:
    log(tmp_path, RATIO, 1.0)
    text = draft_study(tmp_path)
    assert "[gears]" in text
    assert text.count("# ?") == 3  # the robot, the ratio, the motors' constant
    (tmp_path / "study.toml").write_text(text.replace("ratio = [1, 1, 1]", "ratio = [32, 45, -48]"))
    assert np.ptp(load_study(tmp_path).recording(load_study(tmp_path).trials[0])["joint.joint1.position"].value) < 3.0


def test_a_draft_of_joints_has_none(tmp_path: Path) -> None:
    log(tmp_path, np.eye(3), 1.0)
    file = tmp_path / "log.csv"
    file.write_text(file.read_text().replace("i1,i2,i3", "tau1,tau2,tau3"))
    assert "[gears]" not in draft_study(tmp_path)


def test_a_currents_unit_and_zero_become_the_torques(tmp_path: Path) -> None:
    q, torque = log(tmp_path, COUPLED, 0.07)
    plain = study(tmp_path, COUPLED)
    text = plain.path.read_text()
    for k in (1, 2, 3):  # the same currents, said to be in mA, and each from a zero of its own
        text = text.replace(
            f'i{k} = {{ is = "joint.{"abc"[k - 1]}.current"',
            f'i{k} = {{ is = "joint.{"abc"[k - 1]}.current", unit = "mA", scale = 1000, offset = {k}',
        )
    plain.path.write_text(text)
    seen = load_study(tmp_path).recording("1")
    zeros = 0.07 * COUPLED.T @ np.array([1e-3, 2e-3, 3e-3])
    for k, joint in enumerate("abc"):
        np.testing.assert_allclose(seen[f"joint.{joint}.torque"].value, torque[:, k] + zeros[k], atol=1e-9)
    assert q.shape[1] == 3


def test_a_doubted_factor_of_a_motor_is_one_of_each_joint_that_it_turns(tmp_path: Path) -> None:
    """Its standard deviation goes through the ratio as its factor does; that of the raw motor was kept."""
    log(tmp_path, COUPLED, 0.07)
    plain = study(tmp_path, COUPLED)
    text = plain.path.read_text()
    said = 'i2 = { is = "joint.b.current", unit = "mA"'
    text = text.replace('i2 = { is = "joint.b.current"', f"{said}, plus = {{ q1 = [0, 5.0] }}")
    for k, j in ((1, "a"), (3, "c")):
        text = text.replace(f'i{k} = {{ is = "joint.{j}.current"', f'i{k} = {{ is = "joint.{j}.current", unit = "mA"')
    plain.path.write_text(text)
    seen = load_study(tmp_path).recording("1")
    assert "q1" not in seen["joint.a.torque"].beside
    for joint, ratio in (("b", COUPLED[1, 1]), ("c", COUPLED[1, 2])):
        column, sigma = seen[f"joint.{joint}.torque"].beside["q1"]
        assert sigma == pytest.approx(0.07 * ratio * 1e-3 * 5.0)
        assert np.ptp(column) > 1.0
