"""A draft is not diagnosed: what it lacks is said in one line, until its author has deleted the word."""

from __future__ import annotations

from pathlib import Path

import pytest
from helpers_recordings import HEAD, STREAM, TRIAL, write_study

from spacerobot.cli.main import main
from spacerobot.recordings.lacking import WRIST, lacks, unstated
from spacerobot.recordings.study import load_study

DRAFT = HEAD.replace("format = 1\n", "format = 1\ndraft = true\n")


def test_a_draft_is_refused_with_its_line_and_nothing_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_study(tmp_path, DRAFT + STREAM + TRIAL)
    out = tmp_path / "out"
    assert main(["diagnose", str(tmp_path), "--out", str(out)]) == 2
    err = capsys.readouterr().err
    assert "study.toml:2" in err
    assert "contact.stiffness" in err
    assert "wrist.stiffness" not in err
    assert err.count("\n") == 1
    assert not out.exists()


def test_without_the_word_it_is_read_as_any_study(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_study(tmp_path, HEAD + STREAM + TRIAL)
    main(["diagnose", str(tmp_path)])
    assert "draft" not in capsys.readouterr().err


@pytest.mark.parametrize("name", WRIST)
def test_a_value_is_asked_for_until_it_is_stated_or_called_unknown(tmp_path: Path, name: str) -> None:
    stated = {n: "1.0" for n in WRIST if n != name}
    for value in (None, "2.0", '"unknown"'):
        lines = "".join(f"{n} = {v}\n" for n, v in {**stated, **({name: value} if value else {})}.items())
        text = f'format = 1\ndraft = true\n[baseline]\nrobot = "pa10_wrist"\n{lines}{STREAM}'
        write_study(tmp_path, text + TRIAL.replace("target.mass = 9.0\n", ""))
        assert unstated(load_study(tmp_path)) == (() if value else (name,))


def test_questions_stand_until_their_comment_is_deleted(tmp_path: Path) -> None:
    write_study(tmp_path, DRAFT + STREAM.replace("[streams.mocap]", "[streams.mocap]  # ? which clock") + TRIAL)
    assert "which clock" in lacks(load_study(tmp_path))
    write_study(tmp_path, DRAFT + STREAM + TRIAL)
    assert "answer" not in lacks(load_study(tmp_path))


def test_check_shows_what_a_draft_lacks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_study(tmp_path, DRAFT + STREAM + TRIAL, "t,x\n" + "".join(f"{i},{i * i}\n" for i in range(30)))
    assert main(["study", "check", str(tmp_path)]) == 0
    assert capsys.readouterr().out.rstrip().splitlines()[-1].startswith("draft: ")


def test_draft_must_be_true_or_false(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_study(tmp_path, DRAFT.replace("true", '"yes"') + STREAM + TRIAL)
    assert main(["study", "check", str(tmp_path)]) == 2
    assert "study.toml:2" in capsys.readouterr().err
