"""What docs/proof.md and the README say of the proof is what the published records say."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from spacerobot.proof.published import read_batch
from spacerobot.proof.rates import Record
from spacerobot.proof.summary import MOVES, rates, sealed, usable
from spacerobot.view.proof.batches import EARLIER, batches

ROOT = Path(__file__).parents[2]
RECORDS = ROOT / "docs" / "proof_records.jsonl"

pytestmark = pytest.mark.skipif(not RECORDS.exists(), reason="not in the source tree: the records are not installed")


QUOTED = ("in_set", "confidently_wrong", "coverage")
"""Rates that the README tells: those that say what an answer may not be believed for."""


@pytest.fixture(scope="module")
def records() -> list[Record]:
    return list(read_batch(RECORDS)[1])


def test_every_rate_of_the_page_follows_from_the_records(records: list[Record]) -> None:
    text = (ROOT / "docs" / "proof.md").read_text(encoding="utf-8")
    assert f"{len(sealed(records))} sealed campaigns" in text
    for key, found in rates(records).items():
        assert str(found) in text, key
    wrong = [r for r in usable(records) if r["confidently_wrong"] and not r["same"]]
    for record in wrong:
        assert record["name"] in text


def test_every_batch_is_counted_those_of_earlier_notes_too() -> None:
    text = (ROOT / "docs" / "proof.md").read_text(encoding="utf-8")
    assert text.endswith(batches(ROOT / "docs"))
    rows = [[x.strip() for x in row.split("|")[1:-1]] for row in batches(ROOT / "docs").splitlines() if "| 20" in row]
    earlier = tomllib.loads((ROOT / "docs" / EARLIER).read_text(encoding="utf-8"))["batch"]
    batch, found = read_batch(RECORDS)
    assert sum(int(row[3]) for row in rows) == sum(e["campaigns"] for e in earlier) + len(usable(list(found)))
    told = [e["confidently_wrong"] for e in earlier if "confidently_wrong" in e]
    wrong = sum(int(x.split()[0]) for x in told) + rates(list(found))["confidently_wrong"].hits
    assert sum(int(row[4].split()[0]) for row in rows) == wrong
    (own,) = [row for row in rows if f"`{RECORDS.name}`" in row[-1]]
    assert str(batch["seed"]) in own[1]


def test_a_third_of_them_have_moving_joints_or_a_free_base(records: list[Record]) -> None:
    counted = sealed(records)
    assert sum(r["family"] in MOVES for r in counted) >= len(counted) / 3


def test_the_readme_quotes_the_batch_and_leads_to_it() -> None:
    batch, found = read_batch(RECORDS)
    text = re.sub(r"\s+", " ", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert f"seed {batch['seed']}" in text
    assert batch["date"] in text
    own = rates(list(found))
    for key in QUOTED:
        assert f"{own[key].hits} of {own[key].total}" in text, key
    assert "(docs/proof.md)" in text
