"""One log of several sensors: a row for each of their readings, held readings between, counts without a unit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers_labs import SPEEDS, columns_of, rig

from spacerobot.recordings.cleaning import joined_rows
from spacerobot.recordings.draft import draft_study
from spacerobot.recordings.study import Study, load_study


def sensors(speed: float) -> tuple[np.ndarray, ...]:
    """Times and readings of cameras at 100 Hz, and those of a force sensor at 1,250 Hz."""
    t, x, s, f = rig(speed)
    fine = np.arange(0.0, t[-1], 0.0008)
    return t, x, s, fine, np.interp(fine, t, f) + np.random.default_rng(3).normal(0.0, 0.2, len(fine))


def studied(folder: Path, head: str, rows: list[list[str]]) -> Study:
    for n, own in enumerate(rows, 1):
        (folder / f"run{n}.csv").write_text("\n".join([head, *own]) + "\n")
    (folder / "study.toml").write_text(draft_study(folder))
    return load_study(folder)


def test_a_row_for_each_reading(tmp_path: Path) -> None:
    """Every fiftieth of a second both have a row at the same time."""
    files = []
    for speed in SPEEDS:
        t, x, s, fine, force = sensors(speed)
        told = [(a, f"{a:.5f},{b:.7f},{c:.7f},") for a, b, c in zip(t, x, s, strict=True)]
        told += [(a, f"{a:.5f},,,{b:.4f}") for a, b in zip(fine, force, strict=True)]
        files.append([row for _, row in sorted(told)])
    study = studied(tmp_path, "t,target,slider,force", files)
    for trial, speed in zip(study.trials, SPEEDS, strict=True):
        recording, (t, x, s, fine, force) = study.recording(trial), sensors(speed)
        for name, time, value in (("target.x", t, x), ("wrist.x", t, s), ("contact.force", fine, force)):
            one = recording[name]
            seen = one.time[one.valid]
            np.testing.assert_allclose(seen, time, atol=1e-5)
            assert np.ptp(one.value[one.valid]) == pytest.approx(np.ptp(value), rel=1e-3)
        assert recording["target.x"].rate == pytest.approx(100.0, rel=0.01)


def test_rows_of_one_time_are_joined_where_they_agree() -> None:
    time = np.array([0.0, 0.0, 1.0, 1.0, 2.0])
    values = np.array([[1.0, np.nan], [np.nan, 2.0], [3.0, 4.0], [np.nan, 5.0], [6.0, np.nan]])
    joined = joined_rows(time, values)
    np.testing.assert_array_equal(joined[:2], [[1.0, 2.0], [1.0, 2.0]])
    np.testing.assert_array_equal(joined[2:], values[2:])  # two readings of one channel at one time


def test_a_camera_held_in_a_fast_log_is_its_own(tmp_path: Path) -> None:
    """Of 120 Hz in 1 kHz, written to a micrometre: the noise is the camera's, and signs and zeros are as they are."""
    files = []
    for speed in SPEEDS:
        t, x, s, f = rig(speed)
        fine = np.arange(0.0, t[-1], 0.0012)
        at = np.searchsorted(t, fine, side="right") - 1
        force = np.interp(fine, t, f) + np.random.default_rng(3).normal(0.0, 0.2, len(fine))
        rows = zip(fine, x[at], s[at], force, strict=True)
        files.append([f"{a:.5f},{b:.6f},{c:.6f},{d:.4f}" for a, b, c, d in rows])
    study = studied(tmp_path, "t,target,slider,force", files)
    text = (tmp_path / "study.toml").read_text()
    assert "sign" not in text
    assert "scale" not in text
    for trial in study.trials:
        for name in ("target.x", "wrist.x"):
            assert study.recording(trial)[name].sigma == pytest.approx(1e-4, rel=0.3)


def test_what_a_converter_counts_is_asked(tmp_path: Path) -> None:
    files = []
    for speed in SPEEDS:
        t, x, s, f = rig(speed)
        rows = zip(t, x, s, f, strict=True)
        files.append([f"{a:.4f},{1e3 * b:.4f},{round(2e5 * c)},{round(32768 + 100 * d)}" for a, b, c, d in rows])
    study = studied(tmp_path, "t_s,target_mm,slider_counts,F_raw", files)
    assert columns_of(study) == {"target.x": "target_mm", "wrist.x": "slider_counts", "contact.force": "F_raw"}
    lines = [row for row in (tmp_path / "study.toml").read_text().splitlines() if "counts: state" in row]
    assert [row.split('"')[1] for row in lines] == ["slider_counts", "F_raw"]


@pytest.mark.parametrize(("columns", "asked"), [("thr_1,thr_2", True), ("jet1,jet2", True), ("Fx_N,thr_2", False)])
def test_thrusters_are_asked_what_they_push(tmp_path: Path, columns: str, asked: bool) -> None:
    """Unless the force that they make is logged."""
    rng = np.random.default_rng(2)
    t = np.arange(0.0, 10.0, 0.1)
    body = [0.01 * t, 0.02 * t, 0.01 * t] + 1e-4 * rng.standard_normal((3, t.size))
    rows = np.transpose([t, *body, *(rng.random((2, t.size)) < 0.3)])
    np.savetxt(tmp_path / "log.csv", rows, delimiter=",", header=f"t,x,y,theta,{columns}", comments="", fmt="%.6f")
    text = draft_study(tmp_path)
    assert ("push it, it seems" in text) == asked
    assert ("body.force.x" in text.split("# ?")[0]) != asked
