"""Same input, same bytes: in another process, with other hash seeds and more workers, a diagnosis writes the same."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from helpers_balls import balls

from tests.diagnosis.rigs import write_study

SECONDS = re.compile(rb'"seconds": [\d.]+|<dd>[\d.]+ s</dd>')
"""What a run took: the one thing that may differ, in verdict.json and on the page."""


def written(study: Path, out: Path, seed: str, jobs: str) -> dict[str, bytes]:
    """Verdict and page of one diagnosis, without what it took."""
    command = [sys.executable, "-m", "spacerobot", "diagnose", str(study), "--out", str(out), "--jobs", jobs]
    done = subprocess.run(command, env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()
    return {name: SECONDS.sub(b"", (out / name).read_bytes()) for name in ("verdict.json", "report.html")}


def rig(folder: Path) -> None:
    write_study(folder, planted=[("coulomb_friction", "wrist", {"force_N": 0.3})])


def bodies(folder: Path) -> None:
    balls(folder, {"light": (0.05, 0.003), "heavy": (8.0, 0.003)})


@pytest.mark.parametrize("made", [bodies, pytest.param(rig, marks=pytest.mark.slow)])
def test_two_processes_write_the_same(tmp_path: Path, made: Callable[[Path], None]) -> None:
    study = tmp_path / "study"
    study.mkdir()
    made(study)
    one = written(study, tmp_path / "one", "1", "1")
    assert written(study, tmp_path / "two", "2", "2") == one


def test_nothing_but_what_a_run_took_is_left_out() -> None:
    assert SECONDS.sub(b"", b'"seconds": 1.25,\n"score": 1.25') == b',\n"score": 1.25'
