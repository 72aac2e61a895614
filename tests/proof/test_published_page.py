"""What docs/proof.md and the README say of the proof is what the published records say."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from spacerobot.proof.published import read_batch
from spacerobot.proof.rates import Record
from spacerobot.proof.summary import MOVES, rates, sealed

ROOT = Path(__file__).parents[2]
RECORDS = ROOT / "docs" / "proof_records.jsonl"

pytestmark = pytest.mark.skipif(not RECORDS.exists(), reason="not in the source tree: the records are not installed")


@pytest.fixture(scope="module")
def records() -> list[Record]:
    return list(read_batch(RECORDS)[1])


def test_every_rate_of_the_page_follows_from_the_records(records: list[Record]) -> None:
    text = (ROOT / "docs" / "proof.md").read_text(encoding="utf-8")
    assert f"{len(sealed(records))} sealed campaigns" in text
    for key, found in rates(records).items():
        assert str(found) in text, key
    wrong = [r for r in sealed(records) if r["confidently_wrong"] and not r["same"]]
    for record in wrong:
        assert record["name"] in text


def test_a_third_of_them_have_moving_joints_or_a_free_base(records: list[Record]) -> None:
    counted = sealed(records)
    assert sum(r["family"] in MOVES for r in counted) >= len(counted) / 3


def test_the_readme_quotes_them(records: list[Record]) -> None:
    batch, _ = read_batch(RECORDS)
    text = re.sub(r"\s+", " ", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert f"{len(sealed(records))} sealed campaigns" in text
    assert f"seed {batch['seed']}" in text
    assert batch["date"] in text
    found = rates(records)
    for key in ("nothing_missing", "wrong_parameter", "abstained", "top", "in_set", "confidently_wrong"):
        assert f"{found[key].hits} of {found[key].total}" in text, key
