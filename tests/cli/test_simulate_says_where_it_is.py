"""The first simulation or check after an installation compiles for minutes: whoever waits is told so."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from spacerobot.cli import simulate_run
from spacerobot.cli.main import main
from spacerobot.support import progress
from spacerobot.support.jit import numba
from spacerobot.support.progress import Progress
from tests.door.machines import MACHINES


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What was begun that tells where it is."""
    said: list[str] = []

    class Told(Progress):
        def __init__(self, what: str, *rest: Any, **options: Any) -> None:
            said.append(what)
            super().__init__(what, *rest, **options)

    monkeypatch.setattr(simulate_run, "Progress", Told)
    monkeypatch.setattr(progress, "Progress", Told)
    return said


def test_a_simulation_tells_where_it_is(begun: list[str]) -> None:
    assert main(["simulate", "pa10_wrist", "--wrist-stiffness", "530", "--target-mass", "9", "--speed", "0.07"]) == 0
    assert begun == ["simulating"]


def test_the_first_commands_of_a_stranger_tell_where_they_are(
    tmp_path: Path, begun: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """The first check after an installation compiles for a minute, of which nothing was heard."""
    study = MACHINES["axis"](tmp_path / "s")
    (study / "study.toml").unlink()
    assert main(["study", "new", str(study)]) == 0
    assert main(["study", "check", str(study)]) == 0
    assert begun == ["reading the files, and telling what they are", "reading, and trying the model as believed"]
    assert "channel" in capsys.readouterr().out
    work = Progress("reading the files", quiet=True)
    assert work.line() == "reading the files, 0 s"


def test_whatever_waits_for_a_compiler_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    work = Progress("simulating", 1, unit="scene", quiet=True)
    told = progress.compiling

    def listened(more: int) -> None:
        told(more)
        said.append(work.line())

    monkeypatch.setattr("spacerobot.support.jit.compiling", listened)
    numba().njit(lambda x: x + 1)(1.0)  # kept nowhere, so compiled now
    assert said[0].endswith("s (compiling, once after an installation)")
    assert said[-1] == work.line()
    assert "compiling" not in work.line()
