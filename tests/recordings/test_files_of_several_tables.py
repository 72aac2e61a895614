"""One file with several tables: sheets, topics, structs whose arrays have rates of their own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import openpyxl
import pytest
from helpers_labs import SPEEDS, columns_of, rig
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from scipy.io import savemat

from spacerobot.recordings.draft import draft_study
from spacerobot.recordings.study import Study, load_study


def studied(folder: Path) -> Study:
    (folder / "study.toml").write_text(draft_study(folder), encoding="utf-8")
    study = load_study(folder)
    assert len(study.trials) == len(SPEEDS)
    for trial, speed in zip(study.trials, SPEEDS, strict=True):
        recording = study.recording(trial)
        assert {*recording} == {"target.x", "wrist.x", "contact.force"}
        for name, truth in zip(("target.x", "wrist.x", "contact.force"), rig(speed)[1:], strict=True):
            assert np.ptp(recording[name].value) == pytest.approx(np.ptp(truth), rel=1e-3)
    return study


def test_a_sheet_for_each_trial_with_its_mass_in_its_name(tmp_path: Path) -> None:
    """A target in cm and a plate in mm go the same way: the plate is the wrist by what it does."""
    book = openpyxl.Workbook()
    book.active.append(["drawn up by hand"])
    for n, speed in enumerate(SPEEDS, 1):
        sheet = book.create_sheet(f"Hit {n} ({4 * n} kg)")
        sheet.append(["Impact rig"])
        sheet.append(["Time", "Target", "Plate", "Load"])
        sheet.append(["[ms]", "[cm]", "[mm]", "[N]"])
        for t, x, s, f in zip(*rig(speed), strict=True):
            sheet.append([1e3 * t, 1e2 * x, 1e3 * s, f])
    book.save(tmp_path / "impacts.xlsx")
    study = studied(tmp_path)
    assert [t.overrides["target.mass"] for t in study.trials] == [4.0, 8.0, 12.0]


def test_a_struct_for_each_trial_with_the_force_at_its_own_rate(tmp_path: Path) -> None:
    trials = np.empty((1, len(SPEEDS)), dtype=[(k, object) for k in ("t", "slider_mm", "target_mm", "t_ft", "Fz_kN")])
    for n, speed in enumerate(SPEEDS):
        t, x, s, f = rig(speed)
        fast = np.arange(0, t[-1], 0.002)
        trials[0, n] = (t, 1e3 * s, 1e3 * x, fast, 1e-3 * np.interp(fast, t, f))
    savemat(tmp_path / "all.mat", {"trial": trials})
    (tmp_path / "study.toml").write_text(draft_study(tmp_path))
    study = load_study(tmp_path)
    assert len(study.trials) == len(SPEEDS)
    force, target = (study.recording(study.trials[0])[n] for n in ("contact.force", "target.x"))
    assert len(force.value) > 4 * len(target.value)
    assert np.ptp(force.value) == pytest.approx(np.ptp(rig(SPEEDS[0])[3]), rel=1e-3)


@pytest.mark.parametrize(
    "plugin", [pytest.param(p, marks=pytest.mark.slow) for p in (StoragePlugin.MCAP, StoragePlugin.SQLITE3)]
)
def test_a_bag_of_several_topics(tmp_path: Path, plugin: StoragePlugin) -> None:
    types = get_typestore(Stores.ROS2_HUMBLE)
    kinds = {"pose": "geometry_msgs/msg/PoseStamped", "wrench": "geometry_msgs/msg/WrenchStamped"}
    names = ("std_msgs/msg/Header", "builtin_interfaces/msg/Time", "geometry_msgs/msg/Pose", "geometry_msgs/msg/Point",
             "geometry_msgs/msg/Quaternion", "geometry_msgs/msg/Wrench", "geometry_msgs/msg/Vector3")  # fmt: skip
    header, time, pose, point, turn, wrench, vector = (types.types[n] for n in names)
    for n, speed in enumerate(SPEEDS, 1):
        with Writer(tmp_path / f"run{n}", version=9, storage_plugin=plugin) as writer:
            topics = {"/mocap/floater/pose": "pose", "/mocap/slider/pose": "pose", "/ft/wrench": "wrench"}
            on = {t: writer.add_connection(t, kinds[k], typestore=types) for t, k in topics.items()}
            rng = np.random.default_rng(n)
            for t, x, s, f in zip(*rig(speed), strict=True):
                nanoseconds = 1_700_000_000 * 10**9 + round(1e9 * t)
                stamp = header(stamp=time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9), frame_id="")
                still = turn(x=0.0, y=0.0, z=0.0, w=1.0)
                for topic, y in (("/mocap/floater/pose", x), ("/mocap/slider/pose", s)):
                    at = point(x=rng.normal(0, 1e-5), y=y, z=1.0)
                    message = types.types[kinds["pose"]](header=stamp, pose=pose(position=at, orientation=still))
                    writer.write(on[topic], nanoseconds, types.serialize_cdr(message, kinds["pose"]))
                both = (vector(x=0.0, y=0.0, z=f), vector(x=0.0, y=0.0, z=0.0))
                message = types.types[kinds["wrench"]](header=stamp, wrench=wrench(force=both[0], torque=both[1]))
                writer.write(on["/ft/wrench"], nanoseconds, types.serialize_cdr(message, kinds["wrench"]))
    told = columns_of(studied(tmp_path))
    assert told["target.x"] == "pose.position.y"


def test_stamps_of_seconds_and_nanoseconds_are_no_slider(tmp_path: Path) -> None:
    """A plate that no word calls a wrist: whole seconds rest and then leave, and are none of its readings."""
    for n, speed in enumerate(SPEEDS, 1):
        (tmp_path / f"bag_{n}").mkdir()
        t, x, s, f = rig(speed)
        rng = np.random.default_rng(n)
        stamps = [f"{1_700_000_000 + int(v + 0.3)},{round(1e9 * ((v + 0.3) % 1.0))}" for v in t]
        for name, column in (("floater_pose", x), ("plate_pose", s)):
            rows = [f"{a},{rng.normal(0, 1e-5):.7f},{y:.7f},0.4" for a, y in zip(stamps, column, strict=True)]
            head = "header.stamp.sec,header.stamp.nanosec,pose.position.x,pose.position.y,pose.position.z\n"
            (tmp_path / f"bag_{n}" / f"mocap_{name}.csv").write_text(head + "\n".join(rows) + "\n")
        rows = [f"{a},{y:.5f}" for a, y in zip(stamps, -f, strict=True)]
        (tmp_path / f"bag_{n}" / "ft_wrench.csv").write_text(
            "header.stamp.sec,header.stamp.nanosec,wrench.force.z\n" + "\n".join(rows) + "\n"
        )
    told = columns_of(studied(tmp_path))
    assert told["wrist.x"] == told["target.x"] == "pose.position.y"


@pytest.mark.parametrize("apart", [0.0, 3000.0])
def test_a_message_is_of_when_it_was_made_unless_by_another_clock(tmp_path: Path, apart: float) -> None:
    """What waits by chance to be recorded; a device that counts from when it was switched on shares no clock."""
    rng = np.random.default_rng(4)
    for n, speed in enumerate(SPEEDS, 1):
        t, x, s, f = rig(speed)
        made = 1_700_000_000 + 60 * n + t
        for name, column in (("floater", x), ("slider", s), ("ft_wrench", -f)):
            field = "wrench.force.z" if name == "ft_wrench" else "pose.position.x"
            taken = made + rng.uniform(0.001, 0.008, len(t))
            own = made - (0.0 if name != "slider" else apart)
            rows = [f"{a:.0f},{k},{b:.0f},{v:.7f}" for k, (a, b, v) in enumerate(zip(1e9 * taken, 1e9 * own, column))]
            head = f"%time,field.header.seq,field.header.stamp,field.{field}\n"
            (tmp_path / f"run{n}_{name}.csv").write_text(head + "\n".join(rows) + "\n")
    study = studied(tmp_path)
    clocks = {c.name: stream.time for stream in study.streams.values() for c in stream.channels}
    assert clocks["target.x"] == "field.header.stamp"
    assert (clocks["wrist.x"] == "field.header.stamp") == (apart == 0.0)
