"""Trials one beneath the other in one table, and what a table says of each."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers_labs import SPEEDS, columns_of, rig, written

from spacerobot.recordings.draft import draft, draft_study
from spacerobot.recordings.study import Study, load_study


def table(folder: Path, *, numbers: str, restarts: bool) -> Study:
    """One file of all trials: `numbers` as they are told ("" for none), the clock anew with each or going on."""
    folder.mkdir()
    rows = []
    for n, speed in enumerate(SPEEDS, 1):
        t, x, s, f = rig(speed)
        t = t if restarts else t + 3.0 * n
        number = {"": "", "7": f"{7 * n},", "text": f"hit {'abc'[n - 1]},"}[numbers]
        rows += [f"{number}{5 * n},{a:.4f},{b:.7f},{c:.7f},{d:.4f}" for a, b, c, d in zip(t, x, s, f, strict=True)]
    head = f"{'run,' if numbers else ''}target_mass_kg,t,target,slider,force"
    (folder / "all.csv").write_text("\n".join([head, *rows]) + "\n")
    (folder / "study.toml").write_text(draft_study(folder))
    return load_study(folder)


@pytest.mark.parametrize(("numbers", "restarts"), [("7", True), ("7", False), ("", True), ("text", True)])
def test_each_trial_is_its_rows(tmp_path: Path, numbers: str, restarts: bool) -> None:
    study = table(tmp_path / "rig", numbers=numbers, restarts=restarts)
    assert [t.id for t in study.trials] == (["7", "14", "21"] if numbers == "7" else ["1", "2", "3"])
    assert [t.overrides["target.mass"] for t in study.trials] == [5.0, 10.0, 15.0]
    for trial, speed in zip(study.trials, SPEEDS, strict=True):
        recording = study.recording(trial)
        for name, truth in zip(("target.x", "wrist.x", "contact.force"), rig(speed)[1:], strict=True):
            assert len(recording[name].value) == len(truth)
            assert np.ptp(recording[name].value) == pytest.approx(np.ptp(truth), rel=1e-3)


def test_a_clock_that_stumbles_is_none_of_several_trials(tmp_path: Path) -> None:
    t, x, s, f = rig(SPEEDS[0])
    t[50] = t[40]
    rows = [f"{a:.4f},{b:.7f},{c:.7f},{d:.4f}" for a, b, c, d in zip(t, x, s, f, strict=True)]
    (tmp_path / "all.csv").write_text("\n".join(["t,target,slider,force", *rows]) + "\n")
    assert len(draft(tmp_path).trials) == 1


@pytest.mark.parametrize(
    ("remark", "mass"),
    [("hit with 12.5 kg", 12.5), ("Stoß mit 12,5 kg", 12.5), ("slider 0.8 kg", None), ("12 kg and 3 kg", None)],
)
def test_the_one_mass_of_a_remark_is_the_targets(tmp_path: Path, remark: str, mass: float | None) -> None:
    study = written(tmp_path / "rig", f"{remark}\nt,target,slider,force", "{t:.4f},{x:.7f},{s:.7f},{f:.4f}")
    assert {t.overrides.get("target.mass") for t in study.trials} == {mass}


JOINTS = ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint")


def motion(folder: Path, head: str, names: str = "") -> None:
    t = np.arange(0.0, 4.0, 0.01)
    q = np.array([0.5 * np.sin((1.0 + 0.2 * j) * t) for j in range(6)])
    rows = [f"{a:.4f},{names}" + ",".join(f"{v:.6f}" for v in [*q[:, k], *q[::-1, k]]) for k, a in enumerate(t)]
    folder.mkdir()
    (folder / "joint_states.csv").write_text("\n".join([head, *rows]) + "\n")


def test_numbers_from_nothing_begin_with_the_first_joint(tmp_path: Path) -> None:
    motion(tmp_path / "arm", ",".join(["t", *(f"q{j}" for j in range(6)), *(f"tau{j}" for j in range(6))]))
    (tmp_path / "arm" / "study.toml").write_text(draft_study(tmp_path / "arm", "ur5"))
    told = columns_of(load_study(tmp_path / "arm"))
    assert told == {f"joint.{name}.position": f"q{j}" for j, name in enumerate(JOINTS)} | {
        f"joint.{name}.torque": f"tau{j}" for j, name in enumerate(JOINTS)
    }


@pytest.mark.parametrize("robot", ["ur5", None])
def test_a_messages_names_say_which_joint_is_which(tmp_path: Path, robot: str | None) -> None:
    order = sorted(JOINTS)  # as its publisher sorts them
    fields = [f"field.{f}{j}" for f in ("name", "position", "effort") for j in range(6)]
    motion(tmp_path / "arm", ",".join(["%time", *fields]), names=",".join(order) + ",")
    (tmp_path / "arm" / "study.toml").write_text(draft_study(tmp_path / "arm", robot))
    told = columns_of(load_study(tmp_path / "arm"))
    assert told == {f"joint.{name}.position": f"field.position{j}" for j, name in enumerate(order)} | {
        f"joint.{name}.torque": f"field.effort{j}" for j, name in enumerate(order)
    }


def test_a_wrench_beside_joints_stays_one(tmp_path: Path) -> None:
    head = ",".join(["t", *(f"q_{j}" for j in range(6)), *(f"wrench_{j}" for j in range(6))])
    motion(tmp_path / "joint_log", head)
    found = [line.channel for lines in draft(tmp_path / "joint_log", "panda").lines.values() for line in lines]
    assert sum(c.startswith("joint.") for c in found) == 6
