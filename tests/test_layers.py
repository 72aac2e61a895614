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


def test_the_checker_can_fail() -> None:
    assert violations("model", "from spacerobot.simulation import scene")
    assert violations("theory", "def f():\n    import scipy.linalg")
    assert violations("effects", "if TYPE_CHECKING:\n    from spacerobot.cli.main import entry")
    assert circles(ROOMS, "terms", "from spacerobot.diagnosis.fitting import gauss_newton")
    assert circles(ROOMS, "answer", "def f():\n    from spacerobot.diagnosis.diagnose import diagnose")
    assert not circles(ROOMS, "answer", "from spacerobot.diagnosis.selection.judge import NAMED")
    assert not violations("simulation", "from spacerobot.effects.primitives import Force")
