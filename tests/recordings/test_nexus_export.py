"""Vicon's export: tables at rates of their own, one beneath the other, on one clock."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers_labs import SPEEDS, columns_of, rig

from spacerobot.recordings.draft import draft_study
from spacerobot.recordings.readers import read_table, reader_for
from spacerobot.recordings.study import load_study
from spacerobot.recordings.table import Options
from spacerobot.support.errors import InputError

DEVICES = "Devices\n500\n,,Plate 1 - Force,,,Plate 1 - Moment\nFrame,Sub Frame,Fx,Fy,Fz,Mx\n,,N,N,N,N.mm\n"
MARKERS = "Trajectories\n100\n,,Rig:floater,,,Rig:slider,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n"
OBJECTS = "Objects\n100\n,,box,,,,,\nFrame,Sub Frame,RX,RY,RZ,TX,TY,TZ\n,,rad,rad,rad,mm,mm,mm\n"


def written(path: Path, *, end: str = "\n", mark: str = "") -> Path:
    devices = "".join(f"{k // 5 + 7},{k % 5},{k},0,-{k},1\n" for k in range(50))
    markers = "".join(f"{k + 7},0,{k},2,3,4,,\n" for k in range(10))
    text = mark + DEVICES + devices + "\n" + MARKERS + markers + "\n" + OBJECTS + "7,0,0.1,0.2,0.3,1,2,3\n"
    path.write_bytes(text.replace("\n", end).encode())
    return path


@pytest.mark.parametrize(("end", "mark"), [("\n", ""), ("\r\n", "\ufeff")])
def test_each_table_at_its_rate_on_the_frames_clock(tmp_path: Path, end: str, mark: str) -> None:
    path = written(tmp_path / "trial.csv", end=end, mark=mark)
    assert reader_for(path).name == "nexus"
    assert reader_for(path).parts(path) == ("Devices", "Trajectories", "Objects")
    devices, markers, objects = (read_table(path, Options(variable=v)) for v in reader_for(path).parts(path))
    np.testing.assert_allclose(devices["time"], 0.06 + 0.002 * np.arange(50))
    np.testing.assert_allclose(markers["time"], 0.06 + 0.01 * np.arange(10))
    np.testing.assert_array_equal(devices["Plate 1 - Force.Fz"], -np.arange(50.0))
    np.testing.assert_array_equal(markers["Rig:floater.position.x"], np.arange(10.0))
    assert np.isnan(markers["Rig:slider.position.y"]).all()
    assert [devices.columns[j].unit for j in (3, 6)] == ["N", "N.mm"]
    assert objects["box.rotation.z"] == 0.3
    assert objects["box.position.z"] == 3.0
    assert markers.at(0) == f"{path}:62"


def test_a_folder_of_exports_becomes_a_study(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, x, s, f = rig(speed)
        fine = np.arange(0.0, t[-1], 0.002)
        pulse = np.interp(fine, t, f) + np.random.default_rng(n).normal(0, 0.2, len(fine))
        devices = "".join(f"{k // 5 + 1},{k % 5},0.1,{-p:.4f},0.2,0\n" for k, p in enumerate(pulse))
        rows = "".join(f"{k + 1},0,200,{1e3 * a:.4f},10,210,{1e3 * b:.4f},11\n" for k, (a, b) in enumerate(zip(x, s)))
        (tmp_path / f"Hit {n}.csv").write_text(DEVICES + devices + "\n" + MARKERS + rows)
    (tmp_path / "study.toml").write_text(draft_study(tmp_path))
    study = load_study(tmp_path)
    assert len(study.trials) == len(SPEEDS)
    assert columns_of(study)["target.x"] == "Rig:floater.position.y"
    recording = study.recording(study.trials[-1])
    for name, truth in zip(("target.x", "wrist.x", "contact.force"), rig(SPEEDS[-1])[1:], strict=True):
        assert np.ptp(recording[name].value) == pytest.approx(np.ptp(truth), rel=0.1)
    assert len(recording["contact.force"].value) > 4 * len(recording["target.x"].value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (DEVICES + "1,0,1,2,3,4\n1,1,1,2\n", "ragged"),
        (DEVICES + "1,0,1,2,x,4\n", "column 4"),
        (DEVICES + "1,0,1,2,3,4\n\nsomething else\n", "not a table"),
        (DEVICES + "1,0,1,2,3,4\n\n" + DEVICES + "1,0,1,2,3,4\n", "same name"),
        (DEVICES, "no rows"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "trial.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=said) as error:
        read_table(path)
    assert "trial.csv:" in str(error.value)


def test_a_table_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no such table.*Devices, Trajectories, Objects"):
        read_table(written(tmp_path / "trial.csv"), Options(variable="Forces"))
