"""Whatever a stranger calls things, every page shows it as text: studies, robots and recordings come from anybody.

The report with every text in it made hostile is in test_report.py.
"""

from __future__ import annotations

import ast
import html
import re
import shutil
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spacerobot.cli.main import main
from spacerobot.model.library import load
from spacerobot.recordings.study import load_study, resolve_study
from spacerobot.view.mass.page import MassQuestion, mass_page
from spacerobot.view.notebook.show import show
from spacerobot.view.scene3d.choose import film_of
from spacerobot.view.scene3d.page import page as scene_page
from spacerobot.view.table.page import page as table_page
from tests.view.helpers_report import verdict

PACKAGE = Path(__file__).resolve().parents[2] / "spacerobot"
NAME = "<script>alert(1)</script><img src=x onerror=alert(1)>\"'&|x"


class Found(HTMLParser):
    """Elements and attributes of a page that a stranger's words would have made."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.bad: list[str] = []
        self.script: list[str] = []
        self._inside = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self._inside = tag
        names = {name for name, _ in attributes}
        if any(name.startswith("on") for name in names) or dict(attributes).get("src") == "x":
            self.bad.append(f"{tag} {attributes}")

    def handle_endtag(self, tag: str) -> None:
        self._inside = ""

    def handle_data(self, data: str) -> None:
        if self._inside == "script":
            self.script.append(data)


def harmless(text: str) -> None:
    """The words are there, and nothing that they would do."""
    assert "alert(1)" in text, "the page says them"
    found = Found(text)
    assert not found.bad
    assert not [s for s in found.script if s.strip().startswith("alert(1)")]


def test_the_check_can_fail() -> None:
    for text in (f"<p>{NAME}", f'<p title="{html.escape(NAME)}"><img src=x>alert(1)', "<script>alert(1)</script>"):
        with pytest.raises(AssertionError):
            harmless(text)
    harmless(html.escape(NAME))


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bundled study under a stranger's title."""
    folder = tmp_path_factory.mktemp("study")
    source = resolve_study("guide-friction").parent
    for file in source.iterdir():
        if file.is_file():
            shutil.copy(file, folder)
    text = (folder / "study.toml").read_text(encoding="utf-8")
    words = NAME.replace('"', '\\"')
    (folder / "study.toml").write_text(re.sub("(?m)^title = .*$", lambda _: f'title = "{words}"', text))
    assert load_study(folder).title == NAME
    return folder


def test_overlay(study: Path, tmp_path: Path) -> None:
    assert main(["overlay", str(study), "--trials", "03", "--out", str(tmp_path / "out")]) == 0
    harmless((tmp_path / "out" / "overlay.html").read_text(encoding="utf-8"))


def test_scene_and_notebook(study: Path) -> None:
    film = replace(film_of(str(study), trial="03"), title=NAME, description=NAME)
    harmless(scene_page(film))
    frame = show(film)._repr_mimebundle_()["text/html"]
    assert Found(frame).bad == []
    assert "<script" not in frame


def test_mass() -> None:
    from matplotlib.figure import Figure

    robot = load("pa10_wrist")
    object.__setattr__(robot, "name", NAME)
    names = ("ellipsoid_along_path", "workspace_map", "apparent_mass", "soft_capture")
    figures = {name: Figure() for name in names}
    values = re.findall(r"\bn\.(\w+)", (PACKAGE / "view" / "templates" / "mass.html").read_text(encoding="utf-8"))
    numbers: Any = {**dict.fromkeys(values, 1.0), "spacecraft": NAME}
    harmless(mass_page(MassQuestion(robot, np.zeros(7), np.array([1.0, 0, 0])), figures, numbers))


def test_the_table_of_studies() -> None:
    """Markdown, in which HTML would count."""
    said = {**verdict("named"), "study": NAME, "parts": [], "cpu_seconds": 1.0, "figures": []}
    text = table_page({NAME: said}, absent=[NAME])
    harmless(text)
    row = next(line for line in text.splitlines() if line.startswith("| ["))
    assert row.count("|") == 7, "and no column more"


def test_every_template_escapes_by_itself() -> None:
    """No environment without it, and no template that turns it off."""
    made = 0
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", "")) == "Environment":
                made += 1
                said = {k.arg: getattr(k.value, "value", None) for k in node.keywords}
                assert said.get("autoescape") is True, path
    assert made >= 5
    for path in (p for p in PACKAGE.rglob("*.html") if "templates" in p.parts or "assets" in p.parts):
        assert not re.search(r"\|\s*safe\b|autoescape\s+false", path.read_text(encoding="utf-8")), path
