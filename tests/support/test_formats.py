"""A file of another format is refused in a line that says which side is the older one, whatever kind of file it is."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from spacerobot.diagnosis.answer.mended_model import read_model
from spacerobot.recordings.study import load_study
from spacerobot.simulation.scene_file import read_scene
from spacerobot.support.errors import InputError
from spacerobot.support.formats import require_format
from spacerobot.view.compare.runs import compare


@pytest.mark.parametrize(
    ("number", "said"), [(3, "newer"), (1, "older spacerobot: do it again"), (True, ""), ("2", "")]
)
def test_who_is_older_is_said(number: object, said: str) -> None:
    require_format(2, 2, "study", "here")
    with pytest.raises(InputError, match=f"unknown format of a study.*{said}") as told:
        require_format(number, 2, "study", "here", "do it again")
    assert "\n" not in str(told.value)


def _overlay(path: Path) -> None:
    path.parent.joinpath("overlay.json").write_text(json.dumps({"format": 2, "title": "x", "channels": {}}))
    compare(path.parent, path.parent)


@pytest.mark.parametrize(
    "read", [load_study, read_scene, read_model, _overlay], ids=["study", "scene", "model", "overlay"]
)
def test_every_reader_says_it(tmp_path: Path, read: Callable[[Path], object]) -> None:
    """Before any key is looked at: those of a newer format may be others."""
    file = tmp_path / "file.toml"
    file.write_text("format = 2\nan_unheard_of_key = 1\n")
    with pytest.raises(InputError, match="newer spacerobot"):
        read(file)
