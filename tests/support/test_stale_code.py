"""Nothing made by other code is taken for this code's: compiled functions, finished runs, verdicts of a table."""

from __future__ import annotations

import ast
import functools
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
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


KEPT = {"loops": jit.sources, "laws": jit.sources_of_laws}
"""What is compiled -> the files that it depends on."""


@pytest.mark.parametrize("kind", KEPT)
def test_any_change_in_what_compiled_code_sees_makes_another_cache(copy: Path, kind: str) -> None:
    usual = jit.cache_folder(KEPT[kind]())
    tried = KEPT[kind]()
    assert len(tried) > 40
    for path in tried:
        before = changed(path)
        assert jit.cache_folder(KEPT[kind]()) != usual, path.relative_to(copy)
        path.write_bytes(before)
    assert jit.cache_folder(KEPT[kind]()) == usual


def test_what_compiles_nothing_makes_no_other_cache(copy: Path) -> None:
    usual = [jit.cache_folder(files()) for files in KEPT.values()]
    for name in ("simulation/scene_toml.py", "model/robot.py", "dynamics/effective_mass.py", "support/files.py"):
        changed(copy / name)
    assert [jit.cache_folder(files()) for files in KEPT.values()] == usual
    changed(copy / "effects" / "catalogue" / "adhesion.py")
    assert [jit.cache_folder(files()) == before for files, before in zip(KEPT.values(), usual)] == [True, False]


def test_a_law_moved_to_another_file_makes_another_cache(copy: Path) -> None:
    usual = jit.cache_folder(jit.sources_of_laws())
    (copy / "effects" / "plane.py").rename(copy / "effects" / "level.py")
    assert jit.cache_folder(jit.sources_of_laws()) != usual


MAKERS = {"jit", "part", "lean", "lean_twin", "inlined", "_outlined"}
"""What compiles a function, as decorator or call."""

LAWS = {"Kernel": 0, "Memory": 0, "Friction": 2}
"""What holds a law -> from which argument on its functions stand."""


def name_of(node: ast.expr) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""


@functools.cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def names_in(node: ast.AST) -> set[str]:
    """All that an expression or a function's body names; a call of an attribute by the name before the dot."""
    inside = node.body if isinstance(node, ast.FunctionDef) else [node]
    return {n.id for part in inside for n in ast.walk(part) if isinstance(n, ast.Name)}


def loops_of(path: Path) -> set[str]:
    """What a file's compiled functions name, and the functions that it has compiled by a call."""
    found: set[str] = set()
    if "jit" not in path.read_text(encoding="utf-8"):
        return found
    for node in ast.walk(parsed(path)):
        if isinstance(node, ast.FunctionDef) and MAKERS & {name_of(d) for d in node.decorator_list}:
            found |= names_in(node)
        elif isinstance(node, ast.Call) and name_of(node.func) in MAKERS and defined(path, name_of(node.func)):
            found |= {name for a in node.args for name in names_in(a)}
    return found


def laws_of(path: Path) -> set[str]:
    """What a file hands to kernels, memories and frictions."""
    if not any(f"{name}(" in path.read_text(encoding="utf-8") for name in LAWS):
        return set()
    calls = [n for n in ast.walk(parsed(path)) if isinstance(n, ast.Call) and name_of(n.func) in LAWS]
    given = [a for c in calls for a in (*c.args[LAWS[name_of(c.func)] :], *(k.value for k in c.keywords))]
    return {name for a in given for name in names_in(a)}


def defined(path: Path, name: str) -> tuple[Path, str, ast.stmt] | None:
    """Where in the package a name of a file's top level comes from: file, its name there, the statement."""
    for node in parsed(path).body:
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("spacerobot"):
            for alias in node.names:
                if (alias.asname or alias.name) == name:
                    at = PACKAGE.parent.joinpath(*str(node.module).split("."))
                    if at.with_suffix(".py").is_file():
                        return defined(at.with_suffix(".py"), alias.name)
        elif isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name == name:
            return path, name, node
        elif isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            if any(isinstance(n, ast.Name) and n.id == name for t in targets for n in ast.walk(t)):
                return path, name, node
    return None


def seen_by(path: Path, names: set[str]) -> set[Path]:
    """The files that functions of a file, which name these, come from and read: what they call, and every constant.

    The decorators themselves are hashed whole, and nothing that they name is seen by what they compile.
    """
    ends = {PACKAGE / "support" / "jit.py", PACKAGE / "support" / "parts.py"}
    found, done, todo = {path} if names else set(), set(), [(path, name) for name in names]
    while todo:
        at = todo.pop()
        if at in done:
            continue
        done.add(at)
        where = defined(*at)
        if where is not None:
            file, _, node = where
            found.add(file)
            if file not in ends:
                todo += [(file, name) for name in names_in(node)]
    return found


@pytest.mark.parametrize(("kind", "of"), [("loops", loops_of), ("laws", laws_of)])
def test_no_source_of_compiled_code_is_forgotten(kind: str, of: Callable[[Path], set[str]]) -> None:
    hashed, count = set(KEPT[kind]()), 0
    for path in PACKAGE.rglob("*.py"):
        seen = seen_by(path, of(path))
        assert seen <= hashed, (path, seen - hashed)
        count += bool(seen)
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


@pytest.mark.parametrize(
    "order", [("inside", "outside", "inside"), pytest.param(("outside", "inside", "outside"), marks=pytest.mark.slow)]
)
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
