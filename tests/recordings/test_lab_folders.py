"""Folders of labs: which files, columns and lists belong together, and what a draft makes of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers_labs import SPEEDS, check, rig, written

from spacerobot.recordings.check import check_study
from spacerobot.recordings.draft import draft_study
from spacerobot.recordings.study import load_study


@pytest.mark.parametrize("lag", [0.0, 40.0])
def test_a_folder_a_trial_and_a_file_a_sensor(tmp_path: Path, lag: float) -> None:
    """Files of one trial may each have a clock of their own; the target's zero is found all the same."""
    for n, speed in enumerate(SPEEDS, 1):
        folder = tmp_path / f"run{n}_12,5kg"
        folder.mkdir()
        t, target, wrist, force = rig(speed)
        for name, head, column, late in (
            ("mocap", "stamp_ns,floater_y_m", 0.2 - target, 0.0),
            ("encoder", "time_us,wrist_um", 1e6 * wrist, lag),
            ("ft", "t,Fz", -force - 3.0, 2 * lag),
        ):
            times = (t + late + (1.7e9 if late == 0.0 == lag else 0.0)) * {"m": 1e9, "e": 1e6, "f": 1.0}[name[0]]
            table = np.column_stack([times, column])
            np.savetxt(folder / f"{name}.csv", table, "%.6f", ",", header=head, comments="")
    (tmp_path / "study.toml").write_text(draft_study(tmp_path))
    study = load_study(tmp_path)
    assert [t.overrides["target.mass"] for t in study.trials] == [12.5] * 3
    assert {n for n, s in study.streams.items() if s.own_clock} == ({"encoder", "ft"} if lag else set())
    for trial in study.trials:
        target = study.recording(trial)["target.x"]
        assert abs(np.interp(1.0, target.time - target.time[0], target.value)) < 6e-4
        assert target.value[-1] < target.value.max()


@pytest.mark.parametrize("late", [0.0, 0.5])
def test_a_slow_camera_sees_a_touch_a_frame_later_than_a_fast_force(tmp_path: Path, late: float) -> None:
    """That makes no clock its own, and a push of a dozen frames still tells where the target's zero is."""
    random = np.random.default_rng(5)
    for n, speed in enumerate(SPEEDS, 1):
        for name, rate, sigma in (("mocap", 60.0, 2e-5), ("force", 1000.0, 0.05)):
            t = np.arange(0.0, 2.0, 1.0 / rate)
            pushed = np.where(t > 1.0, speed / 16 * np.sin(np.clip(16 * (t - 1.0), 0, np.pi)), 0.0)
            back = np.clip(t - 1.0 - np.pi / 16, 0, None)
            target = 0.3 + np.where(t > 1.0, pushed - speed * back, speed * (t - 1.0))
            shown = [800 * pushed] if name == "force" else [target, pushed]
            columns = [
                t + (late if name == "force" else 0.0),
                *(x + sigma * random.standard_normal(t.size) for x in shown),
            ]
            head = "time,force" if name == "force" else "time,target_x,wrist_x"
            np.savetxt(tmp_path / f"{name}_{n}.csv", np.column_stack(columns), "%.6f", ",", header=head, comments="")
    (tmp_path / "study.toml").write_text(draft_study(tmp_path))
    study = load_study(tmp_path)
    assert {n for n, s in study.streams.items() if s.own_clock} == ({"force"} if late else set())
    for trial in study.trials:
        target = study.recording(trial)["target.x"]
        assert abs(np.interp(1.0, target.time, target.value)) < 1e-4


@pytest.mark.parametrize(
    "names", [("ch0", "ch1", "ch2", "ch3"), ("時", "ア", "イ", "ウ"), ("tid", "maal x [mm]", "b", "c")]
)
def test_silent_names_are_told_by_what_a_hit_does_and_asked(tmp_path: Path, names: tuple[str, ...]) -> None:
    """In any order, and never of a column that only drifts or only rests."""
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        rng = np.random.default_rng(n)
        extra = {"d": 0.02 * t + rng.normal(0, 1e-4, len(t)), "e": rng.normal(0, 1e-4, len(t))}
        columns = {names[0]: t, names[3]: force, **extra, names[2]: 1e3 * wrist, names[1]: 1e3 * target}
        np.savetxt(
            tmp_path / f"run{n}.csv", np.column_stack(list(columns.values())), "%.6f", ",", header=",".join(columns),
            comments="", encoding="utf-8",
        )  # fmt: skip
    text = draft_study(tmp_path)
    assert text.count("by what it does in a hit, not by its name") == 3
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    study = load_study(tmp_path)
    found = {c.column: c.name for s in study.streams.values() for c in s.channels}
    assert found == {names[1]: "target.x", names[2]: "wrist.x", names[3]: "contact.force"}


def test_arrays_of_a_joint_each_and_wrenches(tmp_path: Path) -> None:
    """A matrix is joints where it holds as many or is called so, else the axes of a vector; a wrench's third is Fz."""
    t = np.arange(0, 2, 0.01)
    q = np.sin(t)[:, None] * np.arange(1, 7)
    np.savez(tmp_path / "log.npz", t=t, q=q, dq=np.gradient(q, t, axis=0), tau=3 * q)
    text = draft_study(tmp_path)
    for j in range(6):
        assert f'"q[{j}]" = {{ is = "joint.joint{j + 1}.position"' in text
        assert f'"tau[{j}]" = {{ is = "joint.joint{j + 1}.torque"' in text
    other = tmp_path / "wrist"
    other.mkdir()
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        still = np.zeros_like(t)
        wrench = np.column_stack([still, still, force, still, still, still])
        pose = np.column_stack([still, target, still, still + 1, still, still, still])
        np.savez(other / f"run{n}.npz", t=t, target_pose=pose, wrist_pos=wrist, FT=wrench)
    (other / "study.toml").write_text(draft_study(other))
    study = load_study(other)
    check(study)
    assert {c.column for s in study.streams.values() for c in s.channels} == {"target_pose[1]", "wrist_pos", "FT[2]"}


def test_an_arms_log_numbers_its_joints_from_zero_or_names_them(tmp_path: Path) -> None:
    t = np.arange(0, 2, 0.01)
    q = np.sin(t)[:, None] * np.arange(1, 7)
    kinds = ("target_q", "actual_q", "actual_qd", "actual_current", "actual_TCP_force")
    head = " ".join(["timestamp", *(f"{k}_{j}" for k in kinds for j in range(6))])
    folder = tmp_path / "ur"
    folder.mkdir()
    np.savetxt(folder / "log.csv", np.column_stack([t, *[q] * 5]), "%.5f", " ", header=head, comments="")
    found = draft_study(folder, "ur5")
    joints = (
        "shoulder_pan_joint",
        "shoulder_lift_joint",
        "elbow_joint",
        "wrist_1_joint",
        "wrist_2_joint",
        "wrist_3_joint",
    )
    for j, joint in enumerate(joints):
        assert f'"actual_q_{j}" = {{ is = "joint.{joint}.position"' in found
        assert f'"target_q_{j}" = {{ is = "joint.{joint}.reference"' in found
        assert f'"actual_current_{j}" = {{ is = "joint.{joint}.current"' in found
    assert '"actual_TCP_force_2" = { is = "hand.force.z"' in found
    folder = tmp_path / "ros"
    folder.mkdir()
    head = ",".join(["%time", *(f"field.{k}.{j}" for k in ("position", "velocity", "effort") for j in joints)])
    stamps = 1.7416e18 + np.round(1e9 * t)
    np.savetxt(folder / "log.csv", np.column_stack([stamps, q, q, q]), "%.6f", ",", header=head, comments="")
    found = draft_study(folder)
    assert "an arm with joint logs" in found
    for joint in joints:
        assert f'"field.position.{joint}" = {{ is = "joint.{joint}.position"' in found
        assert f'"field.effort.{joint}" = {{ is = "joint.{joint}.torque"' in found


def test_check_warns_of_a_shared_clock_by_which_streams_never_meet(tmp_path: Path) -> None:
    t = np.arange(0, 2, 0.01)
    for name, late in (("a", 0.0), ("b", 40.0)):
        np.savetxt(
            tmp_path / f"{name}.csv", np.column_stack([t + late, np.sin(t)]), header="t,x", comments="", delimiter=","
        )
    text = """format = 1
[baseline]
robot = "pa10_wrist"
[streams.a]
time = "t"
channels.x.is = "target.x"
[streams.b]
time = "t"
clock = {clock}
channels.x.is = "wrist.x"
[[trials]]
id = "1"
a = "a.csv"
b = "b.csv"
"""
    (tmp_path / "study.toml").write_text(text.replace("clock = {clock}\n", ""))
    assert any("never run together" in w for w in check_study(load_study(tmp_path))["warnings"])
    (tmp_path / "study.toml").write_text(text.replace("{clock}", '"own"'))
    assert not any("never run together" in w for w in check_study(load_study(tmp_path))["warnings"])


@pytest.mark.parametrize(
    ("name", "rows"),
    [
        ("runs.csv", ["file,target mass [kg],speed", "run1.csv,12.5,1", "run2.csv,12.5,2", "run3.csv,28,3"]),
        ("log.csv", ["Run;Masse Ziel [kg]", "1;12,5", "2;12,5", "3;28,0"]),
        ("plan.txt", ["# of the day", "trial\ttarget_mass_g", "run3\t28000", "run1\t12500", "run2\t12500"]),
    ],
)
def test_masses_come_from_the_labs_list_of_runs(tmp_path: Path, name: str, rows: list[str]) -> None:
    written(tmp_path, "t,target_m,slider_m,force_N", "{t:.3f},{x:.6f},{s:.6f},{f:.4f}")
    (tmp_path / "study.toml").unlink()
    (tmp_path / name).write_text("\n".join(rows))
    text = draft_study(tmp_path)
    assert f"# from {name}" in text
    (tmp_path / "study.toml").write_text(text)
    study = load_study(tmp_path)
    assert [t.overrides["target.mass"] for t in study.trials] == [12.5, 12.5, 28.0]
    check(study)


def test_a_list_of_other_runs_says_nothing(tmp_path: Path) -> None:
    written(tmp_path, "t,target_m,slider_m,force_N", "{t:.3f},{x:.6f},{s:.6f},{f:.4f}")
    (tmp_path / "study.toml").unlink()
    for rows in (["run,mass", "7,1", "8,2"], ["run,mass", "1,1", "1,2"], ["run,slider mass", "1,1", "2,1", "3,1"]):
        (tmp_path / "runs.csv").write_text("\n".join(rows))
        text = draft_study(tmp_path)
        assert "runs.csv" not in text.split("[[trials]]", 1)[1].split("# not read")[0]


def test_a_recording_with_a_column_of_masses_is_no_list(tmp_path: Path) -> None:
    check(written(tmp_path / "rig", "t,target_m,slider_m,force_N,target_mass", "{t:.3f},{x:.6f},{s:.6f},{f:.4f},12.5"))


def test_a_bodys_twist_and_attitude_and_never_a_quaternion(tmp_path: Path) -> None:
    t = np.arange(0, 10, 0.02)
    names = ["stamp", "sat.pose.position.x", "sat.pose.position.y", "sat.pose.orientation.z", "sat.pose.orientation.w"]
    names += [
        "sat.twist.linear.x",
        "sat.twist.angular.z",
        "sat.twist.angular.x",
        "thr_fx_N",
        "thr_mz_Nm",
        "sat_att_deg",
    ]
    rows = np.column_stack([t, *(np.sin((k + 1) * t / 3) for k in range(len(names) - 1))])
    np.savetxt(tmp_path / "log.csv", rows, "%.6f", ",", header=",".join(names), comments="")
    (tmp_path / "study.toml").write_text(draft_study(tmp_path))
    found = {c.column: (c.name, c.use) for s in load_study(tmp_path).streams.values() for c in s.channels}
    assert found == {
        "sat.pose.position.x": ("body.position.x", "output"),
        "sat.pose.position.y": ("body.position.y", "output"),
        "sat.pose.orientation.z": ("body.orientation.z", "output"),
        "sat.pose.orientation.w": ("body.orientation.w", "output"),
        "sat.twist.linear.x": ("body.velocity.x", "output"),
        "sat.twist.angular.z": ("body.velocity.yaw", "output"),
        "thr_fx_N": ("body.force.x", "input"),
        "thr_mz_Nm": ("body.torque.yaw", "input"),
        "sat_att_deg": ("body.yaw", "output"),
    }
