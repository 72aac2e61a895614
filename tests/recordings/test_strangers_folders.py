"""Folders of strangers: what names a column where its own header does not, and what must never become a channel."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import openpyxl
import pytest
from helpers_labs import SPEEDS, check, columns_of, rig, written

from spacerobot.recordings.draft import draft, draft_study
from spacerobot.recordings.drafting.stated_rate import stated_rate
from spacerobot.recordings.study import Study, load_study

TARGET, WRIST, FORCE = "field.pose.position.x", "field.pose.position.x", "field.wrench.force.z"


def studied(folder: Path) -> Study:
    (folder / "study.toml").write_text(draft_study(folder), encoding="utf-8")
    return load_study(folder)


def spans_are_right(study: Study) -> None:
    """Whether each channel goes as far as it did, in SI."""
    for trial, speed in zip(study.trials, SPEEDS, strict=True):
        recording = study.recording(trial)
        assert {*recording} == {"target.x", "wrist.x", "contact.force"}
        for name, truth in zip(("target.x", "wrist.x", "contact.force"), rig(speed)[1:], strict=True):
            assert np.ptp(recording[name].value) == pytest.approx(np.ptp(truth), rel=1e-3)


def test_a_readme_names_the_columns_of_files_that_do_not(tmp_path: Path) -> None:
    said = "Impact tests\n\nColumns:\n 1 time [ms]\n 2 wrist position [um]\n 3 target position [mm]\n"
    said += " 4 contact force [N]\n"
    (tmp_path / "rig").mkdir()
    (tmp_path / "rig" / "README.txt").write_text(said)
    study = written(tmp_path / "rig", "", "{t:.6f}e3 {s:.9f}e6 {x:.8f}e3 {f:.4f}", ending="dat")
    check(study)
    text = (tmp_path / "rig" / "study.toml").read_text()
    assert "wrist position [um], by README.txt" in text
    assert "# ?" not in text


def test_a_list_of_another_length_names_nothing(tmp_path: Path) -> None:
    (tmp_path / "rig").mkdir()
    (tmp_path / "rig" / "README.txt").write_text("1 wrist [mm]\n2 target [mm]\n3 force [N]\n")
    written(tmp_path / "rig", "", "{t:.6f} {x:.8f} {s:.8f} {f:.4f}", ending="dat")
    assert "by README.txt" not in (tmp_path / "rig" / "study.toml").read_text()


def test_a_lists_own_machine_among_others(tmp_path: Path) -> None:
    names = ["Time", "BLACK_Px", "BLACK_Py", "RED_Px", "RED_Py", "RED_Rz", "RED_RzD", "ARM_Elbow_Px", "ARM_Wrist_Px"]
    listed = "index,name\n" + "".join(f"{k},{name}\n" for k, name in enumerate(names))
    (tmp_path / "columns.csv").write_text(listed)
    t = np.arange(0, 4, 0.02)
    rng = np.random.default_rng(1)
    turn = np.mod(2 * t + np.pi, 2 * np.pi) - np.pi
    rate = np.where(t > 2, 4.0, 0.0)  # jumps by more than half a turn, and yet is no angle that was wrapped
    rows = [t, 9 + t, 9 - t, 0.1 * t, 0.2 * t, turn, rate, 0.3 * t, 0.4 * t]
    np.savez(tmp_path / "RED_run1.npz", packet=np.transpose(rows) + np.r_[0, [1e-5] * 8] * rng.normal(size=(200, 9)))
    study = studied(tmp_path)
    told = columns_of(study)
    assert told["body.position.x"] == "packet[3]"
    assert told["body.yaw"] == "packet[5]"
    assert told["body.velocity.yaw"] == "packet[6]"
    assert told["marker.wrist.position.x"] == "packet[8]"  # an arm's, and no slider on a spring
    assert "packet[1]" not in told.values()


@pytest.mark.parametrize(
    ("head", "rate"),
    [
        ("NO_OF_FRAMES\t200\nFREQUENCY\t250\n", 250.0),
        ("Sampling rate [Hz]; 1000,0\n", 1000.0),
        ("Trajectories\n100\n", 100.0),
        ("Capture Frame Rate: 180 fps\n", 180.0),
        ("Frame rate: 100\nSample rate: 1000\n", None),
        ("Run\n100\n", None),
        ("Rate of spin 20\n", None),
    ],
)
def test_a_rate_above_a_table(tmp_path: Path, head: str, rate: float | None) -> None:
    (tmp_path / "a.txt").write_text(head + "x\ty\n1\t2\n")
    assert stated_rate(tmp_path / "a.txt") == rate


def test_a_topics_last_word_is_its_thing_and_its_stamps_are_no_channels(tmp_path: Path) -> None:
    began = 1741774800_000000000
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        stamps = [f"{began + n * 60_000_000_000 + round(1e9 * s)}" for s in t]
        for topic, column, values in (
            ("vrpn_client_node-floater-pose", TARGET, target),
            ("vrpn_client_node-wrist-pose", WRIST, wrist),
            ("bota_ft-wrench", FORCE, force),
        ):
            head = f"%time,field.header.seq,field.header.stamp,{column}"
            rows = [f"{s},{k},{s},{v:.7f}" for k, (s, v) in enumerate(zip(stamps, values, strict=True))]
            (tmp_path / f"run{n}").mkdir(exist_ok=True)
            (tmp_path / f"run{n}" / f"{topic}.csv").write_text("\n".join([head, *rows]))
    study = studied(tmp_path)
    spans_are_right(study)
    assert not any("header" in column for column in columns_of(study).values())


def test_a_folder_for_each_thing(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        for folder, head, values in (
            ("target", "t_ms,x_mm", 1e3 * target),
            ("wrist_encoder", "t_ms,x_um", 1e6 * wrist),
            ("loadcell", "t_ms,load_gf", force / 9.80665e-3),
        ):
            (tmp_path / folder).mkdir(exist_ok=True)
            rows = [f"{1e3 * s:.2f},{v:.5f}" for s, v in zip(t, values, strict=True)]
            (tmp_path / folder / f"run{n}.csv").write_text("\n".join([head, *rows]))
    spans_are_right(studied(tmp_path))


def test_a_slider_whose_name_nobody_knows(tmp_path: Path) -> None:
    head = "t [s];target x [mm];Quux [mm];force [N]"
    study = written(tmp_path / "rig", head, "{t:.4f};{x:.8f}e3;{s:.8f}e3;{f:.4f}")
    check(study)
    assert "Quux" in columns_of(study)["wrist.x"]
    assert "# ? wrist.x by what it does in a hit" in (tmp_path / "rig" / "study.toml").read_text()


@pytest.mark.parametrize(("power", "channel"), [(0, "wrist.x"), (-1, "hand.x")])
def test_a_hand_is_the_wrist_where_it_goes_as_far_as_the_target(tmp_path: Path, power: int, channel: str) -> None:
    row = f"{{t:.6f}},{{x:.8f}},{{s:.8f}}e{power},{{f:.4f}}"
    study = written(tmp_path, "time,floater_x,end_effector_x,force", row)
    assert {"target.x", channel, "contact.force"} == {*columns_of(study)}


def test_final_beside_initial_is_no_force(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    np.savez(tmp_path / "a.npz", states_i=rng.normal(size=(50, 6)), states_f=rng.normal(size=(50, 6)))
    assert not any("force" in name for name in columns_of(studied(tmp_path)))
    np.savez(tmp_path / "a.npz", sensor_f=rng.normal(size=(50, 6)))  # alone it is one
    assert any("force" in line.channel for lines in draft(tmp_path).lines.values() for line in lines)


def test_a_workbooks_list_of_runs(tmp_path: Path) -> None:
    written(tmp_path / "rig", "t,target,slider,force", "{t:.4f},{x:.8f},{s:.8f},{f:.4f}")
    book = openpyxl.Workbook()
    for row in (["Versuch", "Masse (kg)"], [1, 12.5], [2, 12.5], [3, 28]):
        book.active.append(row)
    book.save(tmp_path / "rig" / "Plan.xlsx")
    made = draft(tmp_path / "rig")
    assert made.listed == {"run1": 12.5, "run2": 12.5, "run3": 28.0}


def test_bodies_named_once_above_a_header_that_repeats(tmp_path: Path) -> None:
    head = "NO_OF_FRAMES\t200\nFREQUENCY\t100\nTIME_STAMP\t2025-03-12, 10:10\nBODY_NAMES\tfloater\tcarriage\n"
    head += "X\tY\tYaw\tX\tY\tYaw"
    row = "12\t{x:.8f}e3\t9e1\t11\t{s:.8f}e3\t0"
    study = written(tmp_path / "rig", head, row, ending="tsv")
    told = columns_of(study)
    assert (told["target.x"], told["wrist.x"]) == ("floater.Y", "carriage.Y")
    assert study.streams["log"].rate == 100.0
    units = {c.name: c.unit for c in study.streams["log"].channels}
    assert units["target.yaw"] == "deg"  # nobody says so: asked
    three = head.replace("carriage", "carriage\tthird")  # as many names as no repetition has
    assert "floater.Y" not in columns_of(written(tmp_path / "other", three, row, ending="tsv")).values()


def test_bodies_named_with_the_first_of_their_columns(tmp_path: Path) -> None:
    """Across is a column of every body, and so is along: the one that moves counts."""
    head = "Frame\tTime\tfloater X\tY\tRoll\tcarriage X\tY\tRoll"
    row = "{i}\t{t:.4f}\t12\t{x:.8f}e3\t0.1\t11\t{s:.8f}e3\t0.2"
    told = columns_of(written(tmp_path / "rig", head, row, ending="tsv"))
    assert (told["target.x"], told["wrist.x"]) == ("floater.Y", "carriage.Y")
    uneven = head.replace("carriage X\tY\tRoll", "carriage X\tRoll\tY")  # another order is not carried on
    assert "floater.Y" not in columns_of(written(tmp_path / "other", uneven, row, ending="tsv")).values()


def test_angles_of_no_unit_are_asked_where_radians_would_be_turns(tmp_path: Path) -> None:
    t = np.arange(0, 4, 0.02)
    for size, asked in ((80.0, True), (1.0, False)):
        rows = np.transpose([t, 0.1 * t, 0.2 * t, size * np.sin(t)])
        np.savetxt(tmp_path / "log.csv", rows, delimiter=",", header="t,x,y,theta", comments="")
        text = draft_study(tmp_path)
        assert ('unit = "deg"' in text) == asked == ("are they deg" in text)
