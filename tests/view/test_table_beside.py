"""Figures of others beside ours: which is as good, and what is said where none is."""

from __future__ import annotations

from pathlib import Path

from spacerobot.view.table.beside import beside
from spacerobot.view.table.of_studies import BY_HAND, by_hand


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
