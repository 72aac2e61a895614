"""`spacerobot study new` and `spacerobot study check`."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from helpers_recordings import CSV, HEAD, STREAM, TRIAL, write_study

from spacerobot.cli.main import main
from spacerobot.recordings.draft import draft_study
from spacerobot.recordings.guess import guess
from spacerobot.recordings.study import bundled_studies, load_study
from spacerobot.support.errors import InputError


def test_check_the_bundled_study(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["study", "check", "guide-friction", "--json"]) == 0
    out, err = capsys.readouterr()
    report = json.loads(out)
    assert err == ""
    assert len(report["trials"]) == 12
    assert report["warnings"] == report["errors"] == []
    force = next(c for c in report["trials"][0]["channels"] if c["name"] == "contact.force")
    assert force["rate_hz"] == pytest.approx(1000)
    assert (force["sigma"], force["sigma_stated"], force["missing"]) == (0.25, True, 0)


def test_check_says_what_is_odd_and_exits_with_2_on_errors(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = HEAD + STREAM + TRIAL + TRIAL.replace("01", "02")
    write_study(tmp_path, text, "t,x\n" + "".join(f"{i},{i % 2}\n" for i in range(30)))
    (tmp_path / "02.csv").write_text("t,x\n0,1\n1\n")
    assert main(["study", "check", str(tmp_path)]) == 2
    out = capsys.readouterr().out
    assert "differ more than threefold" in out
    assert "02.csv:3: the row is ragged" in out
    assert "all trials share one condition" in out


def test_check_knows_the_robot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_study(tmp_path, HEAD.replace("pa10_wrist", "pa10_wirst") + STREAM + TRIAL)
    assert main(["study", "check", str(tmp_path)]) == 2
    assert "pa10_wrist" in capsys.readouterr().out


def test_new_study_of_a_campaign_has_its_streams_and_trials(tmp_path: Path) -> None:
    source = bundled_studies()["guide-friction"].parent
    for file in source.glob("*.csv"):
        shutil.copy(file, tmp_path)
    assert main(["study", "new", str(tmp_path)]) == 0
    study, known = load_study(tmp_path), load_study(source)
    assert [t.id for t in study.trials] == [t.id for t in known.trials]
    for trial in ("01", "12"):
        for name, series in known.recording(trial).items():
            np.testing.assert_array_equal(study.recording(trial)[name].value, series.value)
            assert study.recording(trial)[name].sigma == pytest.approx(series.sigma, rel=0.3)


def test_new_never_overwrites_unasked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "01.csv").write_text(CSV)
    (tmp_path / "study.toml").write_text("mine")
    assert main(["study", "new", str(tmp_path)]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert (tmp_path / "study.toml").read_text() == "mine"
    assert main(["study", "new", str(tmp_path), "--overwrite", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["trials"] == ["01"]
    assert main(["study", "new", str(tmp_path), "--out", str(tmp_path / "b.toml")]) == 0
    assert load_study(tmp_path / "b.toml").trials[0].id == "01"


def test_draft_groups_folders_and_tells_what_it_left_out(tmp_path: Path) -> None:
    for trial in ("run1", "run2"):
        (tmp_path / trial).mkdir()
        (tmp_path / trial / "joints.txt").write_text("time q1 dq1\n" + "".join(f"0.{i:02d} {i} 1\n" for i in range(20)))
        (tmp_path / trial / "force.csv").write_text("t_ms;F [lbf]\n" + "".join(f"{i};{i},5\n" for i in range(20)))
    (tmp_path / "broken.csv").write_text("t,x\n0,1\n1,2.3.4\n2,3\n3,4\n")
    (tmp_path / 'quote"and\nline.csv').write_text(CSV)
    text = draft_study(tmp_path)
    (tmp_path / "study.toml").write_text(text)
    study = load_study(tmp_path)
    assert {"run1", "run2"} <= {t.id for t in study.trials}
    assert set(study.trial("run1").sources) == {"joints", "force"}
    force = study.recording("run1")["contact.force"]
    assert force.value[1] == pytest.approx(1.5 * 4.4482216152605)
    assert force.time[1] == pytest.approx(0.001)
    assert "joint.joint1.position" in study.recording("run2")
    assert "# not read: broken.csv:3" in text


def test_empty_folder_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no recording that can be read"):
        draft_study(tmp_path)
    with pytest.raises(InputError, match="no such folder"):
        draft_study(tmp_path / "none")


@pytest.mark.parametrize(
    ("name", "channel", "unit"),
    [
        ("x_target_m", "target.x", None),
        ("target x (mm)", "target.x", "mm"),
        ("yaw_target_deg", "target.yaw", "deg"),
        ("x_wrist", "wrist.x", None),
        ("f_contact_N", "contact.force", None),
        ("Force [lbf]", "contact.force", "lbf"),
        ("q3", "joint.joint3.position", None),
        ("tau7", "joint.joint7.torque", None),
        ("target x (N)", "aux.target_x_N", None),
        ("Analog 1", "aux.Analog_1", None),
    ],
)
def test_guesses(name: str, channel: str, unit: str | None) -> None:
    found = guess(name)
    assert (found.channel, found.unit) == (channel, unit)
