"""Recordings from real hardware: every awkward file is read or refused with line and reason, every study loads."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers_recordings import real

from spacerobot.recordings.readers import read_table
from spacerobot.recordings.study import load_study
from spacerobot.recordings.table import Options
from spacerobot.support.errors import InputError

pytestmark = pytest.mark.real
STUDIES = Path(__file__).resolve().parents[2] / "examples" / "studies" / "real"


def test_motive_export_is_read() -> None:
    table = read_table(real("fixtures", "motive_v1.21_sample_optitrack_take.csv"))
    body = table.columns[table.index("Rigid Body 1.position.x")]
    assert (len(table.columns), len(body.values), body.unit) == (49, 250, "m")
    assert np.median(np.diff(table["Time"])) == pytest.approx(1 / 120, rel=1e-3)
    rotation = np.stack([table[f"Rigid Body 1.rotation.{axis}"] for axis in "xyzw"])
    np.testing.assert_allclose(np.linalg.norm(rotation, axis=0), 1, atol=1e-5)


def test_servo_analyser_is_read_by_either_header_line() -> None:
    table = read_table(real("fixtures", "a3MR.csv"))
    np.testing.assert_array_equal(table["Servo motor speed"], table["Analog 1"])
    assert np.median(np.diff(table["Time"])) == pytest.approx(0.667, rel=1e-3)
    with pytest.raises(InputError, match="11 columns have the same name"):
        table.index("Not selected")


def test_daq_export_keeps_its_two_clocks() -> None:
    table = read_table(real("fixtures", "a3NI.csv"))
    assert table.names() == ("0", "Force", "2", "Input 1")
    for clock in ("0", "2"):
        assert np.median(np.diff(table[clock])) == pytest.approx(0.0005)


def test_forgotten_separator_is_refused_with_its_line() -> None:
    path = real("fixtures", "test9_satellite_velocity_head400.txt")
    with pytest.raises(InputError, match=r":102: column 1: two numbers run together: a separator is missing"):
        read_table(path)


def test_uninitialised_memory_is_refused_with_its_line_and_spares_clean_columns() -> None:
    path = real("fixtures", "uninitialised_memory_object_data.csv")
    with pytest.raises(InputError, match=r":1: column '2' holds a number no sensor gives"):
        read_table(path)
    table = read_table(path, Options(wanted=frozenset({"5", "6", "7"})))
    assert np.isfinite(table["5"]).all()


EXPECTED = {
    "balldrop": (18, {"body.position.z"}),
    "contactnets_cube": (300, {"body.position.z", "body.orientation.w", "body.velocity.x"}),
    "dfki_grasps": (3, {f"joint.panda_joint{i}.position" for i in range(1, 8)}),
    "double_pendulum": (30, {"joint.shoulder.position", "joint.elbow.velocity"}),
    "emps": (2, {"joint.axis.position", "joint.axis.torque", "joint.axis.reference"}),
    "flexible_link": (16, {"joint.motor.torque", "joint.motor.position"}),
    "franka_captures_satellite": (6, {"joint.panda_joint1.position", "target.velocity.yaw", "hand.force.x"}),
    "franka_exciting": (1, {f"joint.panda_joint{i}.torque" for i in range(1, 8)}),
    "ita_air_bearing": (6, {"body.position.x", "body.force.x", "body.yaw"}),
    "kentucky_air_bearing": (1, {"body.position.x", "body.yaw", "body.force.x", "body.torque.yaw"}),
    "planar_impact": (1, {"body.velocity.y.before", "body.velocity.y.after"}),
    "silverbox": (5, {"joint.axis.position", "joint.axis.torque"}),
    "single_pendulum": (6, {"joint.hinge.position", "joint.hinge.velocity"}),
    "spot_free_floating_arm": (2, {"base.position.x", "base.yaw", "joint.elbow.reference"}),
    "spot_other_runs": (4, {"base.position.x", "base.yaw", "link.wrist.position.x"}),
    "staubli_tx40": (1, {f"joint.joint_{i}.position" for i in range(1, 7)}),
    "tiago_arm": (1, {f"joint.arm_{i}_joint.position" for i in range(1, 5)}),
}


def test_every_study_is_expected() -> None:
    assert {p.parent.name for p in STUDIES.glob("*/study.toml")} == set(EXPECTED)


@pytest.mark.parametrize("name", EXPECTED)
def test_study_loads(name: str) -> None:
    real(name)
    study = load_study(STUDIES / name)
    trials, channels = EXPECTED[name]
    assert len(study.trials) == trials
    assert channels <= set(study.channels())
    recording = study.recording(study.trials[0])
    for series in recording.values():
        assert (np.diff(series.time) > 0).all()
        assert np.isfinite(series.value[series.valid]).all()
    if study.robot_file is not None:
        from spacerobot.diagnosis.machines.links import robot_of  # inertias that no body can have are mended

        names = set(robot_of(study).model.names)
        joints = {c.split(".")[1] for c in study.channels() if c.startswith("joint.")}
        assert joints <= names


def test_emps_is_one_axis_at_one_kilohertz() -> None:
    real("emps")
    recording = load_study(STUDIES / "emps").recording("plain")
    force, position = recording["joint.axis.torque"], recording["joint.axis.position"]
    assert (len(force), force.use, force.unit, position.unit) == (24841, "input", "N", "m")
    assert force.rate == pytest.approx(1000, rel=1e-3)
    assert np.abs(position.value).max() < 0.3


def test_franka_exciting_leaves_out_the_repeated_rows() -> None:
    real("franka_exciting")
    recording = load_study(STUDIES / "franka_exciting").recording("exciting")
    share = 1 - len(recording["joint.panda_joint1.position"]) / 20544
    assert share == pytest.approx(0.06, abs=0.01)


def test_spot_momentum_window_has_the_plan_beside_the_markers() -> None:
    real("spot_free_floating_arm")
    recording = load_study(STUDIES / "spot_free_floating_arm").recording("run3")
    assert recording["joint.elbow.reference"].time[[0, -1]] == pytest.approx([42, 72])
    assert recording["base.yaw"].time[[0, -1]] == pytest.approx([41, 72], abs=0.11)
    assert (~recording["link.elbow.position.x"].valid).sum() > 10
    assert not recording["base.force.x"].value[recording["base.force.x"].time > 42].any()


def test_satellite_runs_on_a_clock_of_its_own() -> None:
    real("franka_captures_satellite")
    recording = load_study(STUDIES / "franka_captures_satellite").recording("compensated")
    assert recording["target.velocity.yaw"].clock == "own:satellite"
    assert recording["joint.panda_joint1.position"].clock == "shared"
    assert np.median(recording["target.velocity.yaw"].rate) > 1200


def test_planar_impacts_lose_normal_speed() -> None:
    real("planar_impact")
    recording = load_study(STUDIES / "planar_impact").recording("all")
    before, after = (recording[f"body.velocity.y.{m}"].value for m in ("before", "after"))
    assert len(before) == 1718
    assert (before < 0).mean() > 0.99
    assert np.median(np.abs(after / before)) < 1
