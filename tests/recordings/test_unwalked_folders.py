"""Folders that nobody had walked: cameras that count frames, nested structs, groups with attributes, servos."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import openpyxl
import pytest
from helpers_labs import SPEEDS, columns_of, rig
from scipy.io import savemat

from spacerobot.diagnosis.study_check import check_study
from spacerobot.recordings.draft import draft, draft_study
from spacerobot.recordings.lacking import lacks
from spacerobot.recordings.study import Study, load_study
from spacerobot.recordings.table import Floats

LINK = """<link name="{}"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>"""
JOINT = """<joint name="{}" type="revolute"><parent link="{}"/><child link="{}"/>
<limit lower="-3" upper="3" effort="9" velocity="9"/></joint>"""
LINKS = LINK.format("upper") + LINK.format("fore")
JOINTS = JOINT.format("shoulder", "base", "upper") + JOINT.format("elbow", "upper", "fore")
ARM = f'<robot name="two"><link name="base"/>{LINKS}{JOINTS}</robot>'


def studied(folder: Path) -> Study:
    (folder / "study.toml").write_text(draft_study(folder), encoding="utf-8")
    return load_study(folder)


def table(path: Path, head: str, *columns: Floats) -> None:
    np.savetxt(path, np.column_stack(columns), "%.9g", ",", header=head, comments="")


def test_frames_at_a_stated_rate_are_a_clock_and_a_force_that_began_before_has_its_own(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        head = "Trajectories\n100\n,,Floater:F,Slider:S\nFrame,Sub Frame,X,X\n,,mm,mm"
        table(tmp_path / f"run{n}.csv", head, np.arange(1, len(t) + 1), 0 * t, 1e3 * target, 1e3 * wrist)
        table(tmp_path / f"run{n} plate.csv", "time (s),Fz (lbf)", t + 0.7 * n, force / 4.4482216)
    study = studied(tmp_path)
    assert [t.id for t in study.trials] == ["run1", "run2", "run3"]
    clocks = {c.name: s.clock for s in study.streams.values() for c in s.channels}
    assert clocks["contact.force"] != clocks["target.x"] == clocks["wrist.x"]


def test_files_need_no_suffix_and_a_masss_point_begins_none(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        table(tmp_path / f"run{n}_12.5kg", "time_s,target_x_m,wrist_x_m,contact_force_N", t, target, wrist, force)
    study = studied(tmp_path)
    assert set(study.channels()) == {"target.x", "wrist.x", "contact.force"}
    assert [t.overrides["target.mass"] for t in study.trials] == [12.5] * len(SPEEDS)
    assert study.recording(study.trials[0])["target.x"].value.size == len(rig(SPEEDS[0])[0])


def test_cameras_that_share_the_forces_clock_keep_it(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        head = "Trajectories\n100\n,,Floater:F,Slider:S\nFrame,Sub Frame,X,X\n,,mm,mm"
        table(tmp_path / f"run{n}.csv", head, np.arange(1, len(t) + 1), 0 * t, 1e3 * target, 1e3 * wrist)
        table(tmp_path / f"run{n} plate.csv", "time (s),Fz (lbf)", t, force / 4.4482216)
    assert 'clock = "own"' not in draft_study(tmp_path)


def test_a_target_that_no_name_tells_is_what_drifts_until_the_touch(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        places = np.column_stack([0.3 + 0 * t, -target, 0 * t])
        inside = {"mocap": {"t": t, "sat_pos": places, "probe_pos": wrist}, "ft": {"t": t[::2], "Fz": force[::2]}}
        savemat(tmp_path / f"exp_{n}.mat", {"data": {**inside, "info": {"mass": 7.5 * n}}})
    study = studied(tmp_path)
    assert columns_of(study) == {
        "target.x": "data.mocap.sat_pos[1]",
        "wrist.x": "data.mocap.probe_pos",
        "contact.force": "data.ft.Fz",
    }
    assert set(study.streams) == {"exp_mocap", "exp_ft"}  # by the structs that set them apart
    assert [study.value("target.mass", t) for t in study.trials] == [7.5, 15.0, 22.5]
    assert "target.x by what it does in a hit" in study.path.read_text()
    for trial, speed in zip(study.trials, SPEEDS, strict=True):
        seen = study.recording(trial)["target.x"]
        assert np.median(seen.value - rig(speed)[1]) == pytest.approx(0.0, abs=5e-4)  # along its travel, touching at 0


def test_an_archives_groups_say_the_mass_and_the_clocks(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        with h5py.File(tmp_path / f"shot_{100 + n}.h5", "w") as file:
            file.attrs["target_mass_kg"] = 10.0 + n
            file.attrs["operator"] = "AB"
            cameras, cell = file.create_group("sensors/optitrack"), file.create_group("sensors/loadcell")
            cameras["timestamp_us"] = np.round(1e6 * t).astype(np.int64)
            cameras["floater_xyz"] = np.column_stack([target, 0 * t + 0.2, 0 * t + 0.9])
            cameras["slider_xyz"] = np.column_stack([wrist + 0.3, 0 * t + 0.2, 0 * t + 0.9])
            cell["timestamp_us"] = np.round(1e6 * t[::2]).astype(np.int64)
            cell["force_mN"] = 1e3 * force[::2]
    study = studied(tmp_path)
    assert columns_of(study) == {
        "target.x": "sensors.optitrack.floater_xyz[0]",
        "wrist.x": "sensors.optitrack.slider_xyz[0]",
        "contact.force": "sensors.loadcell.force_mN",
    }
    assert [study.value("target.mass", t) for t in study.trials] == [11.0, 12.0, 13.0]
    recording = study.recording(study.trials[-1])
    assert np.ptp(recording["contact.force"].value) == pytest.approx(np.ptp(rig(SPEEDS[-1])[3][::2]), rel=1e-6)
    assert recording["target.x"].time[-1] == pytest.approx(1.99)


@pytest.mark.parametrize("numbers", [(1, 2), (11, 14)])
def test_servos_on_a_bus_are_the_joints_in_order(tmp_path: Path, numbers: tuple[int, int]) -> None:
    (tmp_path / "two.urdf").write_text(ARM)
    rng = np.random.default_rng(1)
    t = np.arange(0, 4, 0.01)
    said = ("Goal Position(deg)", "Present Position(deg)", "Present Velocity(rpm)", "Present Current(mA)")
    columns = [t * 1e3, *(100 * np.sin((1 + 0.3 * k) * t) + rng.normal(0, 0.1, len(t)) for k in range(8))]
    head = ",".join(["Timestamp(ms)", *(f"ID{n} {quantity}" for n in numbers for quantity in said)])
    table(tmp_path / "log.csv", head, *columns)
    made = draft(tmp_path)
    assert made.kind == "arm"
    study = studied(tmp_path)
    wanted = [f"joint.{j}.{q}" for j in ("shoulder", "elbow") for q in ("reference", "position", "velocity", "torque")]
    assert [c.name for s in study.streams.values() for c in s.channels] == wanted
    # One newton metre for each ampere is what the draft says until it is told; the log is in milliamperes.
    assert np.ptp(study.recording(study.trials[0])["joint.elbow.torque"].value) == pytest.approx(0.2, rel=0.01)


def test_numbered_markers_are_no_motors(tmp_path: Path) -> None:
    t = np.arange(0, 4, 0.01)
    table(tmp_path / "puck.csv", "time [s],m1 x [mm],m2 x [mm],m1 y [mm],m2 y [mm]", t, t, t + 1, 2 * t, 2 * t + 1)
    assert draft(tmp_path).kind != "arm"


def session(path: Path, sign: float) -> list[tuple[float, float]]:
    """Three hits in one recording, the target carried back by hand between them; when each begins and ends, s."""
    times, tracks, pushes, forces, spans = [], [], [], [], []
    began = 0.0
    for speed in SPEEDS:
        t, target, wrist, force = rig(speed)
        back = np.arange(0, 5, 0.01)
        carried = target[-1] + (-SPEEDS[-1] - target[-1]) * (0.5 - 0.5 * np.cos(np.pi * np.clip(back / 4, 0, 1)))
        rng = np.random.default_rng(1)
        times += [began + t, began + 2 + back]
        tracks += [target, carried + rng.normal(0, 1e-4, len(back))]
        pushes += [wrist, rng.normal(0, 1e-4, len(back))]
        forces += [force, rng.normal(0, 0.2, len(back))]
        spans.append((began, began + 2.0))
        began += 7.0
    whole = [np.concatenate(x) for x in (times, tracks, pushes, forces)]
    table(path, "time_s,target_mm,slider_mm,force_N", whole[0], sign * 1e3 * whole[1] + 230, 1e3 * whole[2], whole[3])
    return spans


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_session_in_one_recording_has_a_window_for_each_hit(tmp_path: Path, sign: float) -> None:
    spans = session(tmp_path / "session.csv", sign)
    study = studied(tmp_path)
    assert len(study.trials) == 3
    for trial, (first, last), speed in zip(study.trials, spans, SPEEDS, strict=True):
        assert trial.window is not None
        low, high = trial.window
        assert first - 0.01 <= low < first + 0.9  # not in the hand, and before the touch at 1 s
        assert first + 1.4 < high <= last + 0.01
        seen = study.recording(trial)["target.x"]
        truth = np.interp(seen.time - first, *rig(speed)[:2])
        assert abs(np.median(seen.value - truth)) < 5e-4
    assert "3 hits in one recording" in study.path.read_text()


def test_one_hit_needs_no_window(tmp_path: Path) -> None:
    t, target, wrist, force = rig(0.06)
    table(tmp_path / "only.csv", "time_s,target_mm,slider_mm,force_N", t, 1e3 * target, 1e3 * wrist, force)
    assert "window = " not in draft_study(tmp_path)


def test_an_axis_driven_by_a_current_asks_for_its_constant(tmp_path: Path) -> None:
    t = np.arange(0, 4, 0.01)
    table(tmp_path / "run1.csv", "t,angle_deg,current_mA", t, 50 * np.sin(t), 900 * np.sin(t))
    study = studied(tmp_path)
    assert np.ptp(study.recording(study.trials[0])["joint.axis.torque"].value) == pytest.approx(
        0.9 * np.ptp(np.sin(t)), rel=0.01
    )
    text = study.path.read_text()
    assert "in A: state joint.axis.gain above" in text
    for old, new in (
        ('mass = "unknown"', "mass = 0.02"),
        ("# gain =", "gain = 0.08"),
        ("# joint.axis.gain =", "joint.axis.gain = 0.01"),
        ("# joint.axis.damping =", 'joint.axis.damping = "0.1 N m s/rad"'),
    ):
        assert old in text
        text = text.replace(old, f"{new}   #")
    study.path.write_text(text)
    stated = load_study(tmp_path)
    assert stated.value("joint.axis.gain") == 0.08
    assert "joint.axis.damping" in {*stated.baseline.sigma, *stated.baseline.absolute}


def test_places_too_far_for_a_table_are_asked_for_their_unit(tmp_path: Path) -> None:
    t = np.arange(0, 2, 1 / 60)
    for n in (1, 2):
        table(tmp_path / f"puck{n}.csv", "t,x,y", t, 20 * n * t - 30, 5 * n * t)
    study = studied(tmp_path)
    assert "no unit is stated, and readings span 39" in study.path.read_text()
    assert np.ptp(study.recording(study.trials[0])["body.position.y"].value) < 0.02


def spot(folder: Path) -> None:
    """What a platform's own log has: its track, its thrusters, a marker on its arm, and one that nobody stuck on."""
    t = np.arange(0, 40, 0.1)
    rng = np.random.default_rng(3)
    for n in (1, 2):
        place = [0.1 * n * np.sin(0.1 * t), 0.1 * np.cos(0.1 * t), 0.2 * np.sin(0.2 * t)]
        columns = [x + rng.normal(0, 1e-3, len(t)) for x in (*place, *place[:2])]
        head = "Time,RED_Px,RED_Py,RED_Rz,ARM_Elbow_Px,ARM_Elbow_Py,ARM_Wrist_Px,RED_Fx_Sat"
        table(folder / f"RED_run{n}.csv", head, t, *columns, 0 * t, np.sign(np.sin(t)))


def test_a_channel_that_never_changes_is_left_out_with_a_word(tmp_path: Path) -> None:
    spot(tmp_path)
    made = draft(tmp_path)
    channels = [line.channel for lines in made.lines.values() for line in lines]
    assert "marker.elbow.position.x" in channels
    assert not any("wrist" in c for c in channels)
    assert any("ARM_Wrist_Px: the same reading throughout every trial" in r for r in made.remarks)


def test_what_is_said_to_be_a_platform_is_one_and_a_links_place_is_no_joints_angle(tmp_path: Path) -> None:
    spot(tmp_path)
    (tmp_path / "two.urdf").write_text(ARM)
    text = draft_study(tmp_path, rig="platform")
    for column, channel in (("RED_Px", "base.position.x"), ("RED_Rz", "base.yaw"), ("RED_Fx_Sat", "base.force.x")):
        assert f'"{column}" = {{ is = "{channel}"' in text
    assert '"ARM_Elbow_Px" = { is = "link.elbow.position.x"' in text  # though the URDF has a joint of that name
    assert "# ?" not in text  # its author said which rig it is


@pytest.mark.parametrize(
    ("first", "rest"), [("1-2", "3"), ("run1 to run2", "run3"), ("1, 2", "3"), ("1 and 2", "3"), ("01..02", "03")]
)
def test_a_list_may_name_several_runs_in_a_cell(tmp_path: Path, first: str, rest: str) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, _ = rig(speed)
        table(tmp_path / f"run{n}.csv", "t [s],target [m],slider [m]", t, target, wrist)
    (tmp_path / "index.csv").write_text(f'shots,target_mass_kg\n"{first}",12.5\n"{rest}",30.0\n')
    study = studied(tmp_path)
    assert [study.value("target.mass", t) for t in study.trials] == [12.5, 12.5, 30.0]


def test_a_date_is_no_list_of_runs(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, _ = rig(speed)
        table(tmp_path / f"run{n}.csv", "t [s],target [m],slider [m]", t, target, wrist)
    (tmp_path / "index.csv").write_text("day,target_mass_kg\n2025-06-01,12.5\n2025-06-02,30.0\n")
    assert "target.mass = 12.5" not in draft_study(tmp_path)


@pytest.mark.slow
def test_a_workbooks_mass_may_stand_in_a_cell_with_its_unit(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        book = openpyxl.Workbook()
        sheet = book.active
        assert sheet is not None
        for row in (["Experiment", "capture"], ["Target mass", f"{4.5 + n} kg"], [], ["Time", "Target", "Wrist"]):
            sheet.append(row)
        sheet.append(["s", "m", "m"])
        for row in np.column_stack(rig(speed)[:3]).tolist():
            sheet.append(row)
        book.save(tmp_path / f"Exp{n}.xlsx")
    study = studied(tmp_path)
    assert [study.value("target.mass", t) for t in study.trials] == [5.5, 6.5, 7.5]


def test_one_trial_alone_has_its_zero_found(tmp_path: Path) -> None:
    t, target, wrist, force = rig(0.06)
    head = "t(s),x_target(mm),x_wrist(mm),F(N)"
    table(tmp_path / "test.csv", head, t, 1e3 * target + 300, 1e3 * wrist, force)
    study = studied(tmp_path)
    seen = study.recording(study.trials[0])["target.x"]
    assert np.median(seen.value - target) == pytest.approx(0.0, abs=5e-4)
    report = check_study(study)
    assert not [e for e in report["errors"] if "zero" in e]


def test_a_torque_about_the_tables_normal_turns_the_body(tmp_path: Path) -> None:
    t = np.arange(0, 20, 0.02)
    rng = np.random.default_rng(5)
    torque = np.where(t % 8 < 0.8, 0.03, 0.0)
    rate = np.cumsum(torque / 0.42) * 0.02
    for n in (1, 2):
        places = [x + rng.normal(0, 2e-4, len(t)) for x in (0.03 * n * t, -0.02 * t, np.cumsum(rate) * 0.02)]
        table(tmp_path / f"floater_{n}.csv", "time [s],x [m],y [m],heading [rad],cmd_Tz [Nm]", t, *places, torque)
    study = studied(tmp_path)
    study.path.write_text(study.path.read_text().replace("# mass =", "mass = 18.0 #").replace("draft = true", ""))
    report = check_study(load_study(tmp_path))
    assert report["errors"] == []
    assert report["not_predicted"] == []


def test_a_rig_whose_target_nobody_tracked_asks_for_it(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, _, wrist, force = rig(speed)
        table(tmp_path / f"run{n}.csv", "t [s],slider [m],force [N]", t, wrist, force)
    assert "which column is target.x" in lacks(studied(tmp_path))
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, _ = rig(speed)
        table(tmp_path / f"run{n}.csv", "t [s],slider [m],target [m]", t, wrist, target)
    assert "which column is target.x" not in lacks(studied(tmp_path))
