"""Figures of others beside ours: which is as good, and what is said where none is."""

from __future__ import annotations

from spacerobot.view.table.beside import beside


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
