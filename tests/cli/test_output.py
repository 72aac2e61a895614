"""What a command prints: within the terminal's width, through pipes that close, into streams that are not there."""

from __future__ import annotations

import io
import itertools
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.cli.main import COMMANDS, main
from spacerobot.cli.output import NARROWEST, Fitted, fitted

WIDTH = 40

PRINTS = [
    ["robots"],
    ["robots", "pa10_wrist"],
    ["mass", "pa10_wrist", "--q", "0 45 0 90 0 -45 0", "--deg"],
    ["simulate", "pa10_wrist", "--target-mass", "9"],
    ["study", "check", "guide-friction"],
    ["overlay", "guide-friction", "--trials", "01"],
    *([name, "--help"] for name in COMMANDS),
]


@pytest.mark.parametrize("arguments", PRINTS, ids=lambda a: " ".join(a[:2]))
def test_lines_fit_the_terminal(
    arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", str(WIDTH))
    if "--help" in arguments:
        with pytest.raises(SystemExit):
            main(arguments)
    else:
        assert main(arguments) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines
    assert max(map(len, lines)) <= WIDTH


def test_json_is_not_broken(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("COLUMNS", str(WIDTH))
    assert main(["robots", "--json"]) == 0
    text = capsys.readouterr().out
    assert max(map(len, text.splitlines())) > WIDTH
    json.loads(text)


def test_a_pipe_gets_whole_lines(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    assert main(["robots"]) == 0
    assert max(map(len, capsys.readouterr().out.splitlines())) > 100


_TEXT = st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Cs", "Zl", "Zp")), max_size=200)


@given(line=_TEXT, columns=st.integers(NARROWEST, 60))
def test_nothing_but_spaces_is_lost(line: str, columns: int) -> None:
    shown = fitted(line, columns)
    assert "".join(shown.split()) == "".join(line.split())
    assert all(len(text) <= columns for text in shown.split("\n"))


@given(text=st.text("ab \n", max_size=200), cuts=st.lists(st.integers(0, 200), max_size=5))
def test_lines_are_the_same_however_they_are_written(text: str, cuts: list[int]) -> None:
    stream = io.StringIO()
    shown = Fitted(stream, NARROWEST)
    ends = [0, *sorted(min(c, len(text)) for c in cuts), len(text)]
    for a, b in itertools.pairwise(ends):
        shown.write(text[a:b])
    shown.flush()
    assert stream.getvalue() == "\n".join(fitted(line, NARROWEST) for line in text.split("\n"))


COMMAND = [sys.executable, "-m", "spacerobot"]


@pytest.mark.parametrize("arguments", [["robots"], ["--help"], ["robots", "--json"]], ids=" ".join)
def test_whoever_reads_may_stop(arguments: list[str]) -> None:
    """`| head -0`: no traceback, no complaint."""
    source, sink = os.pipe()
    os.close(source)
    done = subprocess.run([*COMMAND, *arguments], stdout=sink, stderr=subprocess.PIPE, text=True)
    os.close(sink)
    assert done.returncode == 0
    assert done.stderr == ""


@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-", "<&- >&- 2>&-"])
@pytest.mark.parametrize("arguments", ["robots pa10", "--version"])
def test_closed_streams_are_no_error(arguments: str, closed: str, tmp_path: Path) -> None:
    shell = f'"{sys.executable}" -m spacerobot {arguments} {closed}'
    done = subprocess.run(["sh", "-c", shell], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0
    assert done.stderr == ""


def test_files_do_not_become_standard_output(tmp_path: Path) -> None:
    """With standard output closed, the first file opened would take its number, and be printed into."""
    shell = f'"{sys.executable}" -m spacerobot robots pa10 --out "{tmp_path}/out" >&- 2>&-'
    assert subprocess.run(["sh", "-c", shell]).returncode == 0
    json.loads((tmp_path / "out" / "robots.json").read_text())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
@pytest.mark.parametrize("arguments", [["robots"], ["--help"]], ids=" ".join)
def test_a_full_disk_under_standard_output_is_said(arguments: list[str]) -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run([*COMMAND, *arguments], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "No space left" in done.stderr
