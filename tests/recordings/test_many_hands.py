"""One rig, written down as many labs would: `study new` makes the same recording of it in SI, whatever the layout."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.recordings.check import check_study
from spacerobot.recordings.draft import draft_study
from spacerobot.recordings.drafting.files import sentinel
from spacerobot.recordings.drafting.languages import english
from spacerobot.recordings.readers.layout import headings
from spacerobot.recordings.readers.numbers import number
from spacerobot.recordings.study import Study, load_study
from spacerobot.recordings.table import Floats

SPEEDS = (0.03, 0.06, 0.09)
START = datetime(2025, 3, 10, 23, 59, 59, 250000, tzinfo=UTC)

NAMES = {
    "english": ("time", "target pos", "slider pos", "contact force", "slider setpoint"),
    "german": ("Zeit", "Zielposition", "Schlittenweg", "Kontaktkraft", "Soll"),
    "japanese": ("時刻", "ターゲット位置", "手首変位", "接触力", "目標値"),
    "french": ("Temps", "Cible x", "Poignet x", "Force", "Consigne"),
}
ENCODINGS = {
    "english": ("ascii",),
    "german": ("utf-8", "latin-1"),
    "japanese": ("utf-8", "cp932"),
    "french": ("ascii",),
}


def rig(speed: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Times s, target m, slider m and force N of one trial: they touch at 1 s."""
    rng = np.random.default_rng(round(1000 * speed))
    t = np.arange(0, 2, 0.01)
    pushed = np.where(t > 1, speed / 8 * np.sin(np.clip(8 * (t - 1), 0, np.pi)), 0.0)
    target = np.where(t > 1, pushed - 1.5 * speed * np.clip(t - 1 - np.pi / 8, 0, None), speed * (t - 1))
    noise = [rng.normal(0, s, len(t)) for s in (1e-4, 1e-4, 0.2)]
    return t, target + noise[0], pushed + noise[1], 800 * pushed + noise[2]


def clock(form: str, t: Floats) -> list[str]:
    """The times of a trial as loggers write them."""
    if form == "iso":
        return [(START + timedelta(seconds=float(s))).isoformat(timespec="milliseconds") for s in t]
    if form == "points":
        return [(START + timedelta(seconds=float(s))).strftime("%d.%m.%Y %H:%M:%S.%f")[:-3] for s in t]
    if form == "epoch ns":
        return [str(1741600000_000000000 + round(1e9 * s)) for s in t]
    return [f"{s * {'s': 1, 'ms': 1e3}[form]:.3f}" for s in t]


def check(study: Study) -> None:
    assert [t.id for t in study.trials] == ["run1", "run2", "run3"]
    for trial, speed in zip(study.trials, SPEEDS, strict=True):
        t, target, wrist, force = rig(speed)
        recording = study.recording(trial)
        assert list(recording) == ["target.x", "wrist.x", "contact.force"]
        for name, truth, within in (
            ("target.x", target, 5e-4),
            ("wrist.x", wrist, 5e-5),
            ("contact.force", force, 0.1),
        ):
            series = recording[name]
            assert len(series.value) == len(t)
            assert np.ptp(series.time) == pytest.approx(np.ptp(t), abs=2e-3)
            assert abs(np.median(series.value - truth)) < within  # its zero was found again
            assert np.std(series.value - truth) < 1e-3 * np.ptp(truth)  # unit and sign too


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    st.sampled_from(sorted(NAMES)),
    st.sampled_from([(";", ","), (";", "."), (",", "."), ("\t", "."), ("\t", ",")]),
    st.sampled_from(["s", "ms", "iso", "points", "epoch ns"]),
    st.sampled_from(["in the name", "on a line"]),
    st.sampled_from([("m", 1.0), ("mm", 1e3), ("cm", 1e2)]),
    st.booleans(),
    st.floats(-500, 500),
    st.data(),
)
def test_whatever_the_layout_the_recording_is_the_same(
    language: str,
    marks: tuple[str, str],
    form: str,
    units: str,
    unit: tuple[str, float],
    title: bool,
    zero: float,
    data: st.DataObject,
) -> None:
    encoding = data.draw(st.sampled_from(ENCODINGS.get(language, ("ascii",))))
    separator, comma = marks
    time_unit = {"s": "s", "ms": "ms", "epoch ns": "ns"}.get(form, "")
    said = [time_unit, unit[0], unit[0], "N", unit[0]]
    names = [f"{n} [{u}]" if u and units == "in the name" else n for n, u in zip(NAMES[language], said, strict=True)]
    lines = ["Bench 3, 12.03.2025"] if title else []
    lines += [separator.join(names)] + ([separator.join(said)] if units == "on a line" and all(said) else [])
    if units == "on a line" and not all(said):
        unit = ("m", 1.0)  # no line of units can be written above stamps: then it is metres
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for n, speed in enumerate(SPEEDS, 1):
            t, target, wrist, force = rig(speed)
            columns = (target * unit[1] + zero, wrist * unit[1] - zero, force, 0 * t)
            rows = [
                separator.join([stamp.replace(".", comma) if form in ("s", "ms") else stamp, *cells])
                for stamp, *cells in zip(clock(form, t), *_cells(columns, comma), strict=True)
            ]
            (folder / f"run{n}.csv").write_bytes("\n".join([*lines, *rows]).encode(encoding))
        (folder / "study.toml").write_text(draft_study(folder), encoding="utf-8")
        check(load_study(folder))


def _cells(columns: Sequence[Floats], comma: str) -> list[list[str]]:
    return [[f"{v:.6f}".replace(".", comma) for v in column] for column in columns]


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


@pytest.mark.parametrize(
    ("cell", "seconds"),
    [
        ("1970-01-02T00:00:01Z", 86401.0),
        ("1970-01-01 01:00:00,5", 3600.5),
        ("01.01.1970 00:00:02", 2.0),
        ("1/2/1970 00:00:00", 86400.0),
        ("13/1/1970 00:00:00", 12 * 86400.0),
        ("1970-01-01T02:00:00+02:00", 0.0),
        ("23:59:59.25", 86399.25),
        ("1970-13-01 00:00:00", None),
        ("24:00:00", None),
        ("12:61:00", None),
        ("1:2", None),
    ],
)
def test_stamps(cell: str, seconds: float | None) -> None:
    assert number(cell) == seconds


@given(st.datetimes(datetime(1971, 1, 1), datetime(2099, 1, 1)))
def test_a_stamp_is_its_seconds_since_1970(when: datetime) -> None:
    seconds = when.replace(tzinfo=UTC).timestamp()
    for text in (when.isoformat(timespec="microseconds"), when.strftime("%d.%m.%Y %H:%M:%S.%f")):
        assert number(text.replace(f"{when.year}", f"{when.year:04d}")) == pytest.approx(seconds, abs=1e-6)


def test_a_line_of_units_states_them_and_one_of_names_does_not() -> None:
    assert headings([["t", "x"], ["s", "mm"]], 2) == ([("t",), ("x",)], ["s", "mm"])
    assert headings([["t", "x"], ["[s]", "(mm)"]], 2) == ([("t",), ("x",)], ["s", "mm"])
    assert headings([["t", "m"]], 2) == ([("t",), ("m",)], [None, None])  # the only line has the names


@pytest.mark.parametrize("word", ["spacecraft", "satellite", "list", "coupled", "time_ms", "target_x", "Force"])
def test_english_stays_english(word: str) -> None:
    assert english(word) == word


def written(folder: Path, head: str, row: str, encoding: str = "utf-8", ending: str = "csv") -> Study:
    """Three trials in a layout: `row` is formatted with n, t, x, s, f and i, the row's number."""
    folder.mkdir(exist_ok=True)
    for n, speed in enumerate(SPEEDS, 1):
        rows = enumerate(zip(*rig(speed), strict=True))
        text = [row.format(i=i, n=n, t=t, d=1e9 * (0.4 + t / 86400), x=x, s=s, f=f) for i, (t, x, s, f) in rows]
        (folder / f"run{n}.{ending}").write_text("\n".join([head, *text]), encoding=encoding)
    (folder / "study.toml").write_text(draft_study(folder), encoding="utf-8")
    return load_study(folder)


def columns_of(study: Study) -> dict[str, str]:
    return {c.name: c.column for s in study.streams.values() for c in s.channels}


def test_a_camera_systems_export_names_things_above_their_axes(tmp_path: Path) -> None:
    head = "Trajectories\n100\n,,rig:target,,,rig:slider,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm"
    head += "\n,,,,,,,"
    study = written(tmp_path / "rig", head, "{i},0,500,{x:.6f}e3,210,480,{s:.6f}e3,200")
    assert columns_of(study) == {"target.x": "rig:target.Y", "wrist.x": "rig:slider.Y"}
    assert study.streams["log"].rate == 100.0  # as it happens: it has no clock, and the draft asks
    assert "# ? Hz" in (tmp_path / "rig" / "study.toml").read_text()
    units = {c.unit for c in study.streams["log"].channels}
    assert units == {"mm"}


def test_a_loggers_header_of_several_lines(tmp_path: Path) -> None:
    head = "LabVIEW Measurement\nDecimal_Separator\t.\nChannels\t3\nSamples\t200\t200\t200"
    head += "\nY_Unit_Label\tmm\tmm\tN\n***End***\t\t\t\nX_Value\tTarget\tSlider\tForce\tComment"
    study = written(tmp_path / "rig", head, "{t:.4f}\t{x:.6f}e3\t{s:.6f}e3\t{f:.4f}", ending="lvm")
    check(study)


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


QUOTED = '"{t:.3f}","{x:.6f}","{s:.6f}","{f:.4f}"'


@pytest.mark.parametrize(
    ("head", "row"),
    [
        ("sep=;\nt [s];target [m];slider [m];force [N]", "{t:.3f};{x:.6f};{s:.6f};{f:.4f}"),
        ('"t","target_m","slider_m","force_N"', QUOTED),
        ("# run 5\n# t [s], target_x [m], slider_x [m], F [N]", "{t:.3f}, {x:.6f}, {s:.6f}, {f:.4f}"),
        ("", "{t:.3f} {x:.6f} {s:.6f} {f:.4f}"),
        ("t,mode,target_m,slider_m,force", "{t:.3f},RUN,{x:.6f},{s:.6f},{f:.4f}"),
        ("t;target [m];slider [m];force;", "{t:.3f};{x:.6f};{s:.6f};{f:.4f};"),
        ("time,target,slider,force", "{t:.3f},{x:.6f},{s:.6f},{f:.4f}"),
        ("datenum,target,slider,force", "739685.{d:09.0f},{x:.6f},{s:.6f},{f:.4f}"),
    ],
)
def test_what_loggers_leave(tmp_path: Path, head: str, row: str) -> None:
    check(written(tmp_path / "rig", head, row))


def test_a_decimal_comma_within_quotes(tmp_path: Path) -> None:
    study = written(tmp_path / "rig", "t;target;slider;force", "{t:.3f};{x:.6f};{s:.6f};{f:.4f}")
    for file in (tmp_path / "rig").glob("*.csv"):
        rows = (",".join(f'"{c}"' for c in line.split(";")) for line in file.read_text().replace(".", ",").splitlines())
        file.write_text("\n".join(rows))
    (tmp_path / "rig" / "study.toml").write_text(draft_study(tmp_path / "rig"))
    check(load_study(study.path))


def test_a_reading_that_stands_for_none_is_said_to(tmp_path: Path) -> None:
    study = written(tmp_path / "rig", "t,target_m,slider_m,force_N", "{t:.3f},{x:.6f},{s:.6f},{f:.4f}")
    for file in (tmp_path / "rig").glob("*.csv"):
        rows = [line.split(",") for line in file.read_text().splitlines()]
        for row in rows[7::31]:
            row[1] = "-9999"
        file.write_text("\n".join(map(",".join, rows)))
    text = draft_study(tmp_path / "rig")
    assert "missing = [-9999.0]" in text
    study.path.write_text(text)
    for trial in load_study(study.path).trials:
        target = load_study(study.path).recording(trial)["target.x"]
        assert 0 < np.sum(~target.valid) < 10
        assert np.nanmin(target.value) > -1.0


@given(st.lists(st.floats(-10, 10), min_size=4, max_size=40, unique=True), st.integers(0, 3))
def test_only_what_is_far_from_all_others_and_given_again_stands_for_none(values: list[float], again: int) -> None:
    assert sentinel(np.array(values)) is None
    with_it = np.array([*values, *[-9999.0] * again])
    assert sentinel(with_it) == (-9999.0 if again > 1 else None)


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


def test_numbers_too_large_for_metres_are_taken_for_millimetres_and_asked(tmp_path: Path) -> None:
    study = written(tmp_path / "rig", "t,target,slider,force", "{t:.3f},{x:.6f}e3,{s:.6f}e3,{f:.4f}")
    check(study)
    text = study.path.read_text()
    assert text.count('unit = "mm"') == 2
    assert text.count("are they mm") == 1


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
        "thr_mz_Nm": ("body.torque.z", "input"),
        "sat_att_deg": ("body.yaw", "output"),
    }
