"""A file of effects is run only after that was said."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from spacerobot.cli.main import main

FILE = """
import sys
print("I am at work", file=sys.stderr)
raise RuntimeError("and fail")
"""


@pytest.mark.parametrize("arguments", [["diagnose", "guide-friction"], ["simulate", "pa10_wrist"]], ids=lambda a: a[0])
def test_it_is_said_before_it_runs(arguments: list[str], tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text(FILE)
    done = subprocess.run(
        [sys.executable, "-m", "spacerobot", *arguments, "--effects", str(file)], capture_output=True, text=True
    )
    lines = done.stderr.splitlines()
    assert lines[:2] == [f"running the code of {file} for its effects", "I am at work"]
    assert done.returncode == 2
    assert "RuntimeError: and fail" in lines[-1]


@pytest.mark.parametrize("command", [["diagnose", "guide-friction"], ["simulate", "pa10_wrist"]])
def test_a_file_that_cannot_be_read_is_not_announced(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bytes.py").write_bytes(b"\xff\xfe\xfa")
    for name in ("absent.py", "bytes.py", "."):
        assert main([*command, "--effects", str(tmp_path / name)]) == 2
        said = capsys.readouterr().err
        assert "running" not in said
        assert "--effects" in said
