"""The tutorial is walked word for word: its commands run, print what it shows, and its edits are those it lists."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest

from spacerobot.cli.main import main
from spacerobot.recordings.study import load_study

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", PAGE, re.DOTALL)
BELIEF = re.compile(r"[+-](# )?(wrist\.|target\.)?(mass|stiffness|damping) =")


def run(command: str, capsys: pytest.CaptureFixture[str]) -> str:
    """What a line of the page prints; the one word that is no command of ours is done here."""
    words = command.split()
    if words[0] == "head":
        return "\n".join(Path(words[3]).read_text().splitlines()[: int(words[2])])
    assert words[0] == "spacerobot"
    assert main(words[1:]) == 0
    return capsys.readouterr().out


def edited(text: str, block: str) -> str:
    """The text with the block's lines taken out and put in, at the first place where they stand."""
    out = "".join(f"{line[1:]}\n" for line in block.splitlines() if line.startswith("-"))
    put = "".join(f"{line[1:]}\n" for line in block.splitlines() if line.startswith("+"))
    assert out in text
    return text.replace(out, put, 1)


def test_the_tutorial_is_what_happens(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    study = Path("my_rig/study.toml")
    said = ""
    for kind, text in BLOCKS:
        if kind == "sh":
            said = "\n".join(run(line, capsys) for line in text.strip().splitlines())
        elif kind == "text":
            for line in text.strip("\n").splitlines():
                assert line in said.splitlines()
        elif kind == "toml":
            assert text in study.read_text()
        elif kind == "diff":
            if "draft" in text:
                assert main(["diagnose", "my_rig"]) == 2  # the draft asks first
                assert "wrist.stiffness" in capsys.readouterr().err
            study.write_text(edited(study.read_text(), text))
    assert not load_study("my_rig").draft
    warned = [line for line in said.splitlines() if line.startswith("warning")]
    assert all(any(line in text for kind, text in BLOCKS if kind == "text") for line in warned)


@pytest.mark.slow
def test_its_verdict_is_the_friction_that_the_rig_was_made_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "examples" / "newcomer" / "semicolons", "my_rig")
    assert main(["study", "new", "my_rig"]) == 0
    study = Path("my_rig/study.toml")
    for kind, text in BLOCKS:
        if kind == "diff":
            study.write_text(edited(study.read_text(), text))
    capsys.readouterr()
    assert main(["diagnose", "my_rig", "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)["effects"]
    low, high = found["parameters"]["force_N"]["ci95"]
    assert (found["effect"], found["where"]) == ("coulomb_friction", "wrist")
    assert low <= 0.28 <= high


def test_at_most_five_lines_are_edited_beyond_the_beliefs() -> None:
    lines = [line for kind, text in BLOCKS if kind == "diff" for line in text.splitlines()]
    beyond = [line for line in lines if not BELIEF.match(line)]
    assert len(lines) > 10
    assert len(beyond) <= 5
