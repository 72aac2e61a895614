"""Figures of others beside ours: which is as good, and what is said where none is."""

from __future__ import annotations

from pathlib import Path

from spacerobot.view.table.beside import beside
from spacerobot.view.table.of_studies import BY_HAND, by_hand
from spacerobot.view.table.page import page
from tests.view import helpers_report


def verdict(after: list[float], note: str = "") -> dict[str, object]:
    return {
        "figures": [
            {
                "what": "y drift",
                "unit": "mm",
                "note": note,
                "theirs": {"before": [108.0, 131.0], "after": [7.0, 29.0]},
                "ours": {"before": [120.0, 125.0], "after": after},
            }
        ]
    }


def test_ours_is_as_good_where_it_is_no_larger() -> None:
    text = "\n".join(beside({"a": verdict([5.0, 28.0]), "b": verdict([5.0, 30.0], "one run"), "c": verdict([])}))
    rows = [line for line in text.splitlines() if line.startswith("| [")]
    assert [r.rsplit("|", 2)[1].strip() for r in rows] == ["yes", "no: one run", "no"]
    assert "108 to 131 → 7 to 29" in rows[0]
    assert "not measured" in rows[2]


def test_without_figures_there_is_no_section() -> None:
    assert beside({"a": {}}) == []


def test_what_is_written_by_hand_below_the_line_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    assert by_hand(path) == ""
    path.write_text(f"# made\n{BY_HAND}\n\n## Mine\n", encoding="utf-8")
    assert by_hand(path) == f"{BY_HAND}\n\n## Mine\n"
    path.write_text("# made\n", encoding="utf-8")
    assert by_hand(path) == ""
    page = Path(__file__).parents[2] / "docs" / "real-recordings.md"
    assert "\n## " in by_hand(page), "the next `make real-table` keeps it"


def test_sets_that_cannot_be_told_apart_are_said_once() -> None:
    """What they have in common, whatever joint it is at, and then in what they differ."""

    def one_of(*sets: str) -> str:
        effects = [[dict(zip(("effect", "where"), e.split("@"), strict=True)) for e in s.split()] for s in sets]
        said = {**helpers_report.verdict("ambiguous"), "study": "Arm", "parts": [], "cpu_seconds": 1.0, "figures": []}
        said |= {"effects": [], "alternatives": [{"effects": e} for e in effects]}
        row = next(line for line in page({"arm": said}).splitlines() if line.startswith("| ["))
        return row.split("|")[3].strip()

    assert one_of("bias@log", "scale@log") == "bias or scale"
    common = "preload@joint.1 coulomb_friction@joint.2 preload@joint.3"
    told = one_of(f"asymmetric_friction@joint.1 {common}", f"coulomb_friction@joint.1 {common}")
    assert told == "preload, Coulomb friction, asymmetric Coulomb friction or Coulomb friction"
    assert one_of("preload@joint.1", "preload@joint.1 bias@log") == "preload, nothing more or bias"
    assert one_of("preload@joint.1 bias@log") == "preload, bias"
    assert one_of() == ""
