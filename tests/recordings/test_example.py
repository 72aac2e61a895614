"""The tutorial's folder comes with the package: whoever has the wheel alone walks it too."""

from __future__ import annotations

from pathlib import Path

import pytest

from spacerobot import example_recordings, new_study
from spacerobot.cli.main import main
from spacerobot.support.errors import InputError


def test_it_is_raw_and_makes_a_study(tmp_path: Path) -> None:
    folder = example_recordings(tmp_path / "mine")
    assert [p.suffix for p in folder.iterdir()] == [".csv"] * 8
    assert len(new_study(folder).trials) == 8


def test_nothing_is_overwritten(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "empty").mkdir()
    assert main(["study", "example", str(tmp_path / "empty")]) == 0
    assert "study new" in capsys.readouterr().out
    with pytest.raises(InputError, match="something is there already"):
        example_recordings(tmp_path / "empty")
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="something is there already"):
        example_recordings(tmp_path / "file")


def test_where_it_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="cannot be written"):
        example_recordings(tmp_path / "file" / "beneath")
