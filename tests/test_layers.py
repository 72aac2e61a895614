"""Layers import one way; the imports are parsed, not trusted."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent / "spacerobot"
_ORDER = ["support", "model", "dynamics", "effects", "simulation", "recordings", "diagnosis", "proof"]
_ORDER += ["sweep", "view", "cli"]
ALLOWED: dict[str, set[str]] = {layer: set(_ORDER[: i + 1]) for i, layer in enumerate(_ORDER)}
ALLOWED["theory"] = {"theory"}
for _layer in _ORDER[_ORDER.index("simulation") :]:
    ALLOWED[_layer].add("theory")
NUMPY_ONLY = {"theory"}
ROOMS = ["terms", "machines", "fitting", "locate", "selection", "learning", "answer", "forward"]
"""Folders of diagnosis in the order of their imports; what lies beside them may import them all."""


def imports_of(source: str) -> set[str]:
    """Every module named by an import anywhere in the file, TYPE_CHECKING blocks and functions included."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative imports hide the layer"
            found.add(node.module or "")
            found.update(f"{node.module}.{alias.name}" for alias in node.names)
    return found


def violations(layer: str, source: str) -> list[str]:
    bad = []
    for name in imports_of(source):
        parts = name.split(".")
        if parts[0] == "spacerobot" and len(parts) > 1 and parts[1] in ALLOWED and parts[1] not in ALLOWED[layer]:
            bad.append(name)
        third_party = parts[0] in {"scipy", "pinocchio", "numba", "yourdfpy", "matplotlib", "meshcat"}
        if layer in NUMPY_ONLY and third_party:
            bad.append(name)
    return bad


def circles(rooms: list[str], room: str, source: str) -> list[str]:
    """Modules of diagnosis that a file of one of its folders may not import: those of a later one, or beside them."""
    below = set(rooms[: rooms.index(room) + 1])
    names = [n.split(".") for n in imports_of(source) if n.startswith("spacerobot.diagnosis.")]
    return [".".join(n) for n in names if n[2] not in below]


@pytest.mark.parametrize("room", ROOMS)
def test_folders_of_the_diagnosis_import_one_way(room: str) -> None:
    here = {p.name for p in (ROOT / "diagnosis").iterdir() if (p / "__init__.py").exists()}
    assert here == set(ROOMS)
    bad = {f.name: circles(ROOMS, room, f.read_text()) for f in (ROOT / "diagnosis" / room).rglob("*.py")}
    assert not {k: v for k, v in bad.items() if v}


@pytest.mark.parametrize("layer", sorted(p.name for p in ROOT.iterdir() if (p / "__init__.py").exists()))
def test_layer_imports_point_down(layer: str) -> None:
    assert layer in ALLOWED, f"layer {layer} has no place in the order"
    bad = {str(f.relative_to(ROOT)): violations(layer, f.read_text()) for f in (ROOT / layer).rglob("*.py")}
    assert not {k: v for k, v in bad.items() if v}


def files_in_circles(sources: dict[str, str]) -> list[set[str]]:
    """Files that import one another, by module's name to its source; what is merely typed or loaded late counts too."""
    into: dict[str, set[str]] = {}
    for name, source in sources.items():
        named = {n for n in imports_of(source) if n in sources and n != name}
        into[name] = {n for n in named if not any(m.startswith(f"{n}.") for m in named)}  # a folder stands for its file
    reach: dict[str, set[str]] = {}
    for name in into:
        seen, front = set(), {name}
        while front := {other for one in front for other in into[one]} - seen:
            seen |= front
        reach[name] = seen
    circles = [{name, *(o for o in seen if name in reach[o])} for name, seen in reach.items() if name in seen]
    return [c for k, c in enumerate(circles) if c not in circles[:k]]


def test_no_files_import_one_another() -> None:
    files = [f for f in ROOT.rglob("*.py") if f != ROOT / "__init__.py"]
    names = {f: ".".join(f.relative_to(ROOT.parent).with_suffix("").parts).removesuffix(".__init__") for f in files}
    assert not files_in_circles({name: f.read_text() for f, name in names.items()})


def test_the_checker_can_fail() -> None:
    assert files_in_circles({"a": "import b", "b": "def f():\n    import c", "c": "import a", "d": "import a"}) == [
        {"a", "b", "c"}
    ]
    assert not files_in_circles({"a": "import b", "b": "import c", "c": ""})
    assert violations("model", "from spacerobot.simulation import scene")
    assert violations("theory", "def f():\n    import scipy.linalg")
    assert violations("effects", "if TYPE_CHECKING:\n    from spacerobot.cli.main import entry")
    assert circles(ROOMS, "terms", "from spacerobot.diagnosis.fitting import gauss_newton")
    assert circles(ROOMS, "answer", "def f():\n    from spacerobot.diagnosis.diagnose import diagnose")
    assert not circles(ROOMS, "answer", "from spacerobot.diagnosis.selection.judge import NAMED")
    assert not violations("simulation", "from spacerobot.effects.primitives import Force")
