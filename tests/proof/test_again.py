"""What went wrong in a batch, played again: those campaigns and no others, and what is said of them now."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from spacerobot.cli.main import main
from spacerobot.proof import batch
from spacerobot.proof.orders import FULL, Order, schedule
from spacerobot.proof.published import as_lines
from spacerobot.proof.summary import missed
from tests.proof.test_batch import fake_play

SEED = 7
FIELDS = {"withheld": None, "wrong_values": [], "moved": []}


def record(order: Order, folder: Path, **changes: Any) -> dict[str, Any]:
    return {**fake_play(order, folder), **FIELDS, **changes}


@pytest.fixture
def published(tmp_path: Path) -> tuple[Path, dict[str, str]]:
    """Records of a batch: (their file, name by what was wrong with it)."""
    orders: dict[str, Order] = {}
    for order in schedule(FULL, SEED):
        orders.setdefault(order.kind, order)
    wrong = {"top": False, "in_set": False, "confidently_wrong": True}
    made = {
        "claimed": record(orders["nothing_missing"], tmp_path, said="wrong_parameter", **wrong),
        "overlooked": record(orders["two"], tmp_path, said="unknown", top=False, in_set=False, favourite=[]),
        "faint": record(orders["power"], tmp_path, said="nothing_missing", top=False, in_set=False, strength=1.0),
        "in the set": record(orders["masked"], tmp_path, said="ambiguous", top=False),
        "stood in for": record(orders["withheld"], tmp_path, same=True, **{**wrong, "said": "named"}),
        "named outside": record(orders["outsider"], tmp_path, abstained=False, said="named", **wrong),
        "right": record(orders["rare"], tmp_path),
    }
    lines = as_lines({"seed": SEED, "date": "2026-01-01", "codes": {"wrist": "a", "driven arm": "b"}}, [*made.values()])
    path = tmp_path / "records.jsonl"
    path.write_text(lines, encoding="utf-8")
    return path, {why: r["name"] for why, r in made.items()}


def test_what_is_wrong_is_played_again_and_nothing_else(
    published: tuple[Path, dict[str, str]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path, names = published
    wrong = {names[why] for why in ("claimed", "overlooked", "named outside")}
    played: list[tuple[str, int]] = []

    def play(order: Order, folder: Path, **rest: Any) -> dict[str, Any]:
        played.append((order.name, order.seed))
        changes = {"said": "unknown", "top": False, "in_set": False} if order.name == names["overlooked"] else {}
        return record(order, folder, **changes)

    monkeypatch.setattr(batch, "play", play)
    asked = ["prove", "--again", str(path), "--out", str(tmp_path / "out"), "--docs", str(tmp_path / "docs")]
    assert main([*asked, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert {name for name, _ in played} == wrong
    seeds = {o.name: o.seed for o in schedule(FULL, SEED)}
    assert all(seeds[name] == seed for name, seed in played)
    assert (answer["wrong"], answer["played"], answer["right_now"]) == (3, 3, 2)
    text = (tmp_path / "docs" / "proof_again.md").read_text(encoding="utf-8")
    rows = {line.split("|")[1].strip(): line for line in text.splitlines() if line.startswith("|")}
    assert wrong <= set(rows)
    assert rows[names["overlooked"]].split("|")[-2].strip() == "no"
    assert rows[names["claimed"]].split("|")[-2].strip() == "yes"
    assert "**2** are right" in text
    assert main([*asked, "--page", "again_once_more"]) == 0  # finished: reused
    assert (tmp_path / "docs" / "again_once_more.md").read_text(encoding="utf-8") == text
    assert len(played) == 3


def test_a_batch_without_a_fault_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(batch, "play", lambda *a, **k: pytest.fail("played"))
    right = record(schedule(FULL, SEED)[0], tmp_path)
    assert missed([right]) == []
    path = tmp_path / "records.jsonl"
    path.write_text(as_lines({"seed": SEED, "date": "d", "codes": {}}, [right]), encoding="utf-8")
    assert main(["prove", "--again", str(path), "--out", str(tmp_path / "out")]) == 0
    assert "nothing went wrong" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "more", [["--seed", "3"], ["--quick"], ["--kinds", "two"], ["--resume", "x"], ["--page", "../x"]]
)
def test_nothing_else_says_what_is_played(
    published: tuple[Path, dict[str, str]], tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str]
) -> None:
    assert main(["prove", "--again", str(published[0]), "--out", str(tmp_path / "out"), *more]) == 2
    assert more[0] in capsys.readouterr().err
