"""The README's commands and Python run as printed, and print what it says."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from spacerobot.cli.main import COMMANDS, main

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", README, re.DOTALL)


def said_by_commands(kind: str) -> list[tuple[str, str]]:
    """Each block of a kind with the text block that follows it, or nothing."""
    return [
        (text, BLOCKS[i + 1][1] if i + 1 < len(BLOCKS) and BLOCKS[i + 1][0] == "text" else "")
        for i, (name, text) in enumerate(BLOCKS)
        if name == kind
    ]


KEPT = "SPACEROBOT_DEMO"


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> str:
    if KEPT in os.environ:  # who has run it already has kept what it said
        return Path(os.environ[KEPT]).read_text(encoding="utf-8")
    out = tmp_path_factory.mktemp("demo")
    # a process of its own: other tests add effects to this one's catalogue
    done = subprocess.run(
        [sys.executable, "-m", "spacerobot", "demo", "--out", str(out)], capture_output=True, text=True, check=True
    )
    assert (out / "demo.png").stat().st_size > 50_000
    return done.stdout


def test_make_demo_runs_the_demo() -> None:
    assert "make demo" in README
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert re.search(r"^demo:.*\n\t\$\(BIN\)/spacerobot demo ", makefile, re.MULTILINE)


def test_the_demo_prints_what_the_readme_shows(demo: str) -> None:
    shown = [text for kind, text in BLOCKS[: [k for k, _ in BLOCKS].index("python")] if kind == "text"]
    lines = [line for text in shown[:3] for line in text.splitlines()]
    assert len(lines) >= 6
    printed = demo.splitlines()
    for line in lines:
        assert line in printed


def test_the_demo_ends_with_a_page_that_is_there(demo: str) -> None:
    page = Path(demo.splitlines()[-1].removeprefix("Open this page in a browser: "))
    assert page.is_absolute()
    assert page.suffix == ".html"
    assert "<html" in page.read_text(encoding="utf-8")[:200]


@pytest.mark.parametrize(("block", "shown"), [b for b in said_by_commands("sh") if "make demo" not in b[0]])
def test_commands(
    block: str, shown: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    ran = 0
    for line in block.splitlines():
        if line.startswith("spacerobot "):
            assert main(shlex.split(line)[1:]) == 0
            ran += 1
    assert ran
    printed = capsys.readouterr().out.splitlines()
    for line in shown.splitlines():
        assert line in printed


@pytest.mark.parametrize(("block", "shown"), said_by_commands("python"))
def test_python(block: str, shown: str, capsys: pytest.CaptureFixture[str]) -> None:
    exec(compile(block, "README.md", "exec"), {})
    assert capsys.readouterr().out == shown


def test_every_command_is_in_the_table() -> None:
    assert set(re.findall(r"^\| `(\w+)` \|", README, re.MULTILINE)) == set(COMMANDS)


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md"])
def test_links_lead_somewhere(name: str) -> None:
    text = (ROOT / name).read_text(encoding="utf-8")
    links = re.findall(r"\]\(([^)#]+)\)", text)
    assert links
    for link in links:
        assert link.startswith("https://") or (ROOT / link).is_file(), link


def test_the_citation_is_valid_yaml_with_the_paper() -> None:
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    for part in ("cff-version: 1.2.0", "preferred-citation:", "Uyama", "i-SAIRAS 2012", "year: 2012"):
        assert part in text
