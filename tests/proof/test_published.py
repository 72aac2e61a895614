"""A batch's records as one file: they come back whole, and nothing else is taken for them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from spacerobot.cli.main import main
from spacerobot.proof.code_hash import code_hashes
from spacerobot.proof.driven.orders import FAMILY
from spacerobot.proof.orders import QUICK, schedule
from spacerobot.proof.published import SCORED, as_lines, changed, check_orders, read_batch, seed_of, still_valid
from spacerobot.support.errors import InputError
from spacerobot.view.proof.prove import seeds_in_words

BATCH = {"seed": 7, "date": "2026-01-02", "codes": {"wrist": "c0de", FAMILY: "c1de"}}
RECORDS = [
    {"name": o.name, "seed": o.seed, "odd": "line\u2028end \u00b5 é", "family": o.family, **dict.fromkeys(SCORED)}
    for o in schedule(QUICK, 7)
]


def written(folder: Path, text: str | None = None) -> Path:
    path = folder / "records.jsonl"
    path.write_text(as_lines(BATCH, RECORDS) if text is None else text, encoding="utf-8")
    return path


def test_what_was_written_comes_back(tmp_path: Path) -> None:
    assert read_batch(written(tmp_path)) == (BATCH, RECORDS)
    check_orders(RECORDS, schedule(QUICK, 7), "here")


def test_a_campaign_that_could_not_be_made_is_a_record_too(tmp_path: Path) -> None:
    failed = [{"name": "rare-rig-0001", "seed": 1, "failed": "no size could be run"}]
    assert read_batch(written(tmp_path, as_lines(BATCH, failed)))[1] == failed


def test_records_of_another_seed_are_refused() -> None:
    with pytest.raises(InputError, match="no campaign of the batch"):
        check_orders(RECORDS, schedule(QUICK, 8), "here")


def test_records_count_as_long_as_what_they_depend_on_is_unchanged() -> None:
    arm = {"name": "two-driven_arm-0001", "seed": 1, "family": FAMILY}
    every = [*RECORDS, arm]
    codes = BATCH["codes"]
    assert isinstance(codes, dict)
    assert still_valid(BATCH, every, codes, "here") == every
    assert still_valid(BATCH, every, {**codes, FAMILY: "other"}, "here") == RECORDS
    assert still_valid(BATCH, every, {**codes, "wrist": "other"}, "here") == [arm]
    with pytest.raises(InputError, match="other code"):
        still_valid(BATCH, every, dict.fromkeys(codes, "other"), "here")


def test_scenes_whose_code_has_changed_have_a_seed_of_their_own(tmp_path: Path) -> None:
    codes = {"wrist": "c0de", FAMILY: "mended"}
    assert changed(BATCH, codes) == [FAMILY]
    batch = {**BATCH, "redrawn": {FAMILY: {"seed": 11, "date": "2026-01-03"}}}
    batch, _ = read_batch(written(tmp_path, as_lines(batch, RECORDS)))
    assert seed_of(batch, FAMILY) == 11
    assert seed_of(batch, "wrist") == seed_of(BATCH, FAMILY) == 7
    assert seeds_in_words(batch) == "7, 2026-01-02 (driven arm: 11, 2026-01-03)"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "not the records of a batch"),
        ('{"format": 2}\n', "newer spacerobot"),
        ('{"format": 1, "seed": "7", "date": "d", "codes": {}}\n', "states no seed"),
        ('{"format": 1, "seed": 7, "date": "d", "codes": {}}\n{"name": "a"', "not a line of JSON"),
        ('{"format": 1, "seed": 7, "date": "d", "codes": {}}\n[1]\n', "not a JSON object"),
        ('{"format": 1, "seed": 7, "date": "d", "codes": {}}\n{"seed": 3}\n', "without name and seed"),
        ('{"format": 1, "seed": 7, "date": "d", "codes": {}}\n{"seed": 3, "name": "a"}\n', "lacks said"),
        ('{"format": 1, "seed": 7, "date": "d", "codes": {}, "redrawn": {"a": 3}}\n', "drawn anew"),
        ("[" * 100_000, "not a line of JSON"),
    ],
)
def test_a_damaged_file_is_one_clear_error(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        read_batch(written(tmp_path, text))


def test_the_command_refuses_records_of_other_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mujoco", reason="the extra `proof` is not installed")
    path = written(tmp_path)
    assert main(["prove", "--quick", "--out", str(tmp_path / "out"), "--resume", str(path)]) != 0
    assert "diagnosed by other code" in capsys.readouterr().err
    own = as_lines({**BATCH, "codes": code_hashes()}, RECORDS)
    assert main(["prove", "--seed", "7", "--out", str(tmp_path / "out"), "--resume", str(written(tmp_path, own))]) != 0
    assert "--resume without --seed" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_line_break_inside_a_text_does_not_end_the_line(tmp_path: Path) -> None:
    lines = [json.loads(line) for line in written(tmp_path).read_text(encoding="utf-8").split("\n") if line]
    assert len(lines) == 1 + len(RECORDS)
