"""`import spacerobot` as people use it: its names are all there, are what type checkers read, and stay cheap."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import spacerobot

ROOT = Path(__file__).resolve().parents[2]


def test_every_name_is_shown_and_can_be_had() -> None:
    assert set(spacerobot.__all__) <= set(dir(spacerobot))
    for name in spacerobot.__all__:
        assert getattr(spacerobot, name) is not None


def test_no_name_is_that_of_a_package() -> None:
    """Else what the name means would hang on what was imported before."""
    packages = {p.name for p in (ROOT / "spacerobot").iterdir() if (p / "__init__.py").exists()}
    assert not packages & set(spacerobot.__all__)


def test_type_checkers_read_the_same_names_from_the_same_places() -> None:
    tree = ast.parse((ROOT / "spacerobot" / "__init__.py").read_text())
    block = next(n for n in tree.body if isinstance(n, ast.If) and ast.unparse(n.test) == "TYPE_CHECKING")
    read = {a.name: n.module for n in block.body if isinstance(n, ast.ImportFrom) for a in n.names}
    assert all(a.asname == a.name for n in block.body if isinstance(n, ast.ImportFrom) for a in n.names)
    assert read == {name: f"spacerobot.{module}" for name, module in spacerobot._LAZY.items()}


def test_the_import_loads_nothing_heavy() -> None:
    code = (
        "import sys, spacerobot; print(*(m for m in ('numpy', 'pinocchio', 'scipy', 'matplotlib') if m in sys.modules))"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == ""


@pytest.mark.slow
def test_a_type_checker_finds_what_is_wrong_and_nothing_else(tmp_path: Path) -> None:
    """The marked lines of typed.py, their marks taken away: an error in each, and in no other."""
    pytest.importorskip("mypy", reason="extra 'test' is not installed")
    lines = (ROOT / "tests" / "public" / "typed.py").read_text().splitlines()
    marked = {k + 1: line.partition("ignore[")[2].rstrip("]") for k, line in enumerate(lines) if "ignore[" in line}
    bare = tmp_path / "typed.py"
    bare.write_text("\n".join(line.partition("  # type: ignore")[0] for line in lines) + "\n")
    said = subprocess.run(
        [sys.executable, "-m", "mypy", str(bare)], capture_output=True, text=True, cwd=ROOT, check=False
    )
    errors = re.findall(r"typed\.py:(\d+): error: .*\[([\w-]+)\]$", said.stdout, re.MULTILINE)
    assert {int(k): code for k, code in errors} == {k: v for k, v in marked.items() if "..." not in v}, said.stdout
