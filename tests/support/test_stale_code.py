"""Nothing made by other code is taken for this code's: compiled functions, finished runs, verdicts of a table."""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from spacerobot.support import jit, resources, sources

PACKAGE = Path(jit.__file__).resolve().parent.parent


@pytest.fixture
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The package in a tree of its own, which `jit` and `sources` take for the installed one."""
    tree = tmp_path / "spacerobot"
    shutil.copytree(PACKAGE, tree, ignore=shutil.ignore_patterns("__pycache__", "_data"))
    shutil.copytree(resources.folder("urdf"), tmp_path / "urdf")
    monkeypatch.setenv("SPACEROBOT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(jit, "_PACKAGE", tree)
    monkeypatch.setattr(sources, "ROOT", tree)
    monkeypatch.setattr(resources, "_PACKAGE", tree)
    return tree


def changed(path: Path) -> bytes:
    """Replace one character of a file, so that its length stays; what it was."""
    text = path.read_bytes()
    path.write_bytes(text.replace(b"e", b"f", 1) if b"e" in text else text + b"#")
    return text


def test_any_change_in_what_compiled_code_sees_makes_another_cache(copy: Path) -> None:
    usual = jit.cache_folder()
    tried = [p for layer in jit._COMPILED for p in (copy / layer).rglob("*.py")]
    assert len(tried) > 120
    for path in tried:
        before = changed(path)
        assert jit.cache_folder() != usual, path.relative_to(copy)
        path.write_bytes(before)
    assert jit.cache_folder() == usual


def test_a_law_moved_to_another_file_makes_another_cache(copy: Path) -> None:
    usual = jit.cache_folder()
    (copy / "effects" / "laws.py").rename(copy / "effects" / "mores.py")
    assert jit.cache_folder() != usual


DECORATORS = {"jit", "lean", "inlined"}


def compiled_in(tree: ast.Module) -> list[ast.FunctionDef]:
    """The functions that a file hands to one of the decorators of `support.jit`."""

    def name(node: ast.expr) -> str:
        return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""

    functions = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)]
    return [f for f in functions if DECORATORS & {name(d) for d in f.decorator_list}]


def files_of(node: ast.stmt, name: str) -> set[Path]:
    """The package's files that a name comes from, if this statement imports it."""
    if not isinstance(node, ast.ImportFrom) or not node.module or name not in {a.asname or a.name for a in node.names}:
        return set()
    at = PACKAGE.parent.joinpath(*node.module.split("."))
    tries = (at.with_suffix(".py"), at / f"{name}.py", at / "__init__.py")
    return {p for p in tries if p.is_file() and p != PACKAGE / "__init__.py"}


def test_no_source_of_compiled_code_is_forgotten() -> None:
    """A compiled function sees its own file, and those that the names in it come from."""
    hashed = set(jit.sources())
    count = 0
    for path in PACKAGE.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        functions = compiled_in(tree)
        if not functions:
            continue
        count += 1
        assert path in hashed, path
        names = {n.id for f in functions for n in ast.walk(f) if isinstance(n, ast.Name)}
        seen = {p for node in tree.body for name in names for p in files_of(node, name)}
        assert seen <= hashed, (path, seen - hashed)
    assert count > 10


@pytest.mark.parametrize(
    "name",
    ["effects/laws.py", "cli/main.py", "view/report/templates/page.html", "view/report/assets/page.js",
     "diagnosis/answer/verdict.schema.json", "../urdf/pa10.urdf"],
)  # fmt: skip
def test_any_change_of_the_package_makes_another_run(copy: Path, name: str) -> None:
    def found() -> str:
        return sources.package_hash.__wrapped__()

    usual = found()
    path = (copy / name).resolve()
    before = changed(path)
    assert found() != usual
    path.write_bytes(before)
    assert found() == usual
    (copy / "effects" / "__pycache__").mkdir()
    (copy / "effects" / "__pycache__" / "laws.pyc").write_bytes(b"compiled")
    assert found() == usual


def test_a_verdict_of_other_code_is_made_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from spacerobot.recordings.study import load_study, resolve_study
    from spacerobot.support.jsonio import dumps
    from spacerobot.view.table import of_studies

    study = load_study(resolve_study("guide-friction"))
    monkeypatch.setattr(of_studies, "diagnose", lambda *_, **__: (_ for _ in ()).throw(LookupError("made again")))
    monkeypatch.setattr(of_studies, "_quoted", lambda _: ())
    kept = {"input_hash": study.input_hash, "code": of_studies.package_hash(), "verdict": "named"}
    (tmp_path / "guide.json").write_text(dumps(kept))
    assert of_studies._verdict(study, "guide", tmp_path)["verdict"] == "named"
    for other in ({"code": "another"}, {"input_hash": "another"}):
        (tmp_path / "guide.json").write_text(dumps({**kept, **other}))
        with pytest.raises(LookupError):
            of_studies._verdict(study, "guide", tmp_path)


ROWS = """
import sys
import numpy as np
from spacerobot.support.jit import jit, lean_twin

@jit
def rows(s):
    return (s[:6].reshape((2, 3)), s[6:])

inside = lean_twin(rows)

@jit
def total(s):
    found = inside(s)
    return found[0][1, 2] + found[1][0]

s = np.arange(8.0)
print(total(s) if sys.argv[1] == "inside" else [a.shape for a in rows(s)])
"""


@pytest.mark.parametrize("order", [("inside", "outside", "inside"), ("outside", "inside", "outside")])
def test_what_one_process_left_compiled_serves_the_next(tmp_path: Path, order: tuple[str, ...]) -> None:
    """A function and its lean form do not take each other's place on disk, whichever came first."""
    script = tmp_path / "rows.py"
    script.write_text(ROWS)
    for who in order:
        said = subprocess.run(
            [sys.executable, str(script), who],
            env=os.environ | {"SPACEROBOT_CACHE": str(tmp_path / "cache"), "PYTHONPATH": str(PACKAGE.parent)},
            capture_output=True,
            text=True,
            check=True,
        )
        assert said.stdout.strip() == {"inside": "11.0", "outside": "[(2, 3), (2,)]"}[who]
