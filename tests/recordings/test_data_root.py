"""Where a study's files may be: inside the data root, links resolved, and nowhere else."""

from __future__ import annotations

from pathlib import Path

import pytest
from helpers_recordings import CSV, HEAD, STREAM, TRIAL, write_study

from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError


def test_files_outside_the_root_are_refused(tmp_path: Path) -> None:
    (tmp_path / "secret.csv").write_text(CSV)
    folder = tmp_path / "study"
    folder.mkdir()
    for name in ("../secret.csv", str(tmp_path / "secret.csv"), "a/../../secret.csv"):
        study = load_study(write_study(folder, HEAD + STREAM + TRIAL.replace("01.csv", name)))
        with pytest.raises(InputError, match="leaves the data folder"):
            study.recording("01")


def test_links_are_followed_before_they_are_judged(tmp_path: Path) -> None:
    (tmp_path / "secret.csv").write_text(CSV)
    folder = tmp_path / "study"
    folder.mkdir()
    write_study(folder)
    (folder / "01.csv").rename(folder / "real.csv")
    (folder / "01.csv").symlink_to(folder / "real.csv")
    assert len(load_study(folder).recording("01")["target.x"]) == 3
    (folder / "01.csv").unlink()
    (folder / "01.csv").symlink_to(tmp_path / "secret.csv")
    with pytest.raises(InputError, match="leaves the data folder"):
        load_study(folder).recording("01")


def test_data_option_wins(tmp_path: Path) -> None:
    write_study(tmp_path)
    other = tmp_path / "other"
    other.mkdir()
    (other / "01.csv").write_text("t,x\n0,7\n1,8\n")
    assert load_study(tmp_path, data=other).recording("01")["target.x"].value[0] == 7.0
    with pytest.raises(InputError, match="does not exist"):
        load_study(tmp_path, data=tmp_path / "none")


def test_data_key_names_one_variable_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = tmp_path / "data" / "rig"
    data.mkdir(parents=True)
    (data / "01.csv").write_text(CSV)
    monkeypatch.setenv("SPACEROBOT_DATA", str(tmp_path / "data"))
    write_study(tmp_path, 'data = "${SPACEROBOT_DATA}/rig"\n' + HEAD + STREAM + TRIAL)
    assert load_study(tmp_path).root == data
    for wrong, message in (
        ("${HOME}/rig", "no variable but"),
        ("${SPACEROBOT_DATA}/../..", "leaves the data folder"),
        ("/etc", "leaves the data folder"),
        ("../", "leaves the data folder"),
        ("${SPACEROBOT_DATA}/none", "no such folder"),
    ):
        write_study(tmp_path, f'data = "{wrong}"\n' + HEAD + STREAM + TRIAL)
        with pytest.raises(InputError, match=message):
            load_study(tmp_path)


def test_urdf_of_a_study_stays_inside_its_folder(tmp_path: Path) -> None:
    write_study(tmp_path, HEAD.replace("pa10_wrist", "../arm.urdf") + STREAM + TRIAL)
    with pytest.raises(InputError, match="leaves the data folder"):
        _ = load_study(tmp_path).robot_file


def test_hash_follows_every_input(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text("<robot/>")
    write_study(tmp_path, HEAD.replace("pa10_wrist", "arm.urdf") + STREAM + TRIAL)
    seen = {load_study(tmp_path).input_hash}
    assert load_study(tmp_path).input_hash in seen
    for file, text in (("01.csv", CSV + "0.3,9\n"), ("arm.urdf", "<robot />"), ("study.toml", None)):
        path = tmp_path / file
        path.write_text(text if text else path.read_text().replace("0.7", "0.8"))
        seen.add(load_study(tmp_path).input_hash)
    assert len(seen) == 4
