"""The paths that docs/architecture.md prints are those of the code."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

import spacerobot
from spacerobot.support.errors import NotFoundError

PAGE = Path(__file__).resolve().parents[1] / "docs" / "architecture.md"
ROOT = Path(spacerobot.__path__[0])


def named(section: str) -> list[str]:
    """`room/file.name` in a section; rooms of the diagnosis without its name."""
    text = PAGE.read_text(encoding="utf-8").split(f"## {section}\n", 1)[1].split("\n## ", 1)[0]
    return [n for n in re.findall(r"`([a-z_/]+/[a-z_]+\.\w+)`", text) if not n.endswith(".py")]


def found(name: str) -> object:
    path, _, thing = name.rpartition(".")
    for top in ("", "diagnosis/"):
        if (ROOT / f"{top}{path}.py").is_file():
            return getattr(importlib.import_module("spacerobot." + f"{top}{path}".replace("/", ".")), thing)
    raise NotFoundError("file", path, [])


@pytest.mark.parametrize("name", named("Three paths"))
def test_every_stop_of_the_paths_stands(name: str) -> None:
    assert callable(found(name))


def test_the_page_has_paths_and_a_wrong_stop_is_noticed() -> None:
    assert len(named("Three paths")) > 20
    with pytest.raises(NotFoundError):
        found("selection/nowhere.judge")
    with pytest.raises(AttributeError):
        found("selection/judge.nobody")
