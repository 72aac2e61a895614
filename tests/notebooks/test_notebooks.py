"""Every notebook runs from its first cell to its last, and is committed without outputs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from spacerobot.view.notebook.execute import executed

FOLDER = Path(__file__).resolve().parents[2] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
SAYS = {
    "01_effective_mass": ("7.84082 kg",),
    "02_locked_arm_as_a_limit": ("9.69999",),
    "03_the_collision": ("Eq. 16 0.426 s", "7.37 rad/s"),
    "04_from_touch_to_tumble": ("softest place",),
    "05_concealed_friction": ("named", "coulomb_friction at wrist"),
    "06_two_experiments": ("ambiguous", "named", "quadratic_drag"),
    "07_your_robot_your_recording": ("format = 1",),
    "08_a_real_one": ("free-floating",),
    "09_a_law_without_a_name": ("on one stroke only", "is known from"),
}
"""What a reader must find in the outputs."""


def read(path: Path) -> Any:
    return pytest.importorskip("nbformat", reason="extra 'notebooks' is not installed").read(path, 4)


def outputs(notebook: Any) -> list[Any]:
    return [out for cell in notebook.cells if cell.cell_type == "code" for out in cell.outputs]


def test_there_are_nine_of_them() -> None:
    assert [p.stem for p in NOTEBOOKS] == sorted(SAYS)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_notebook_is_committed_bare_and_thin(path: Path) -> None:
    notebook = read(path)
    assert not outputs(notebook), "run without saving, or clear the outputs"
    assert notebook.cells[0].source.startswith("# "), "the question comes first"
    code = "\n".join(c.source for c in notebook.cells if c.cell_type == "code")
    for word in ("def ", "class ", "lambda", "pyplot", "/home/"):
        assert word not in code, f"{word!r}: logic belongs in the package"
    assert "from spacerobot." not in code, "what a notebook needs is public"
    assert "import spacerobot." not in code


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_notebook_runs(path: Path) -> None:
    pytest.importorskip("nbclient", reason="extra 'notebooks' is not installed")
    pytest.importorskip("ipykernel", reason="extra 'notebooks' is not installed")
    notebook = executed(path)
    said = "".join(o.text for o in outputs(notebook) if o.output_type == "stream" and o.name == "stdout")
    if "SKIPPED" in said:
        pytest.skip(said.strip())
    for words in SAYS[path.stem]:
        assert words in said
    assert any("image/png" in o.get("data", {}) or "text/html" in o.get("data", {}) for o in outputs(notebook))
