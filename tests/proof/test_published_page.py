"""What docs/proof.md and the README say of the proof is what the published records say."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from spacerobot.proof.published import read_batch
from spacerobot.proof.rates import Record
from spacerobot.proof.summary import MOVES, missed, rates, sealed, usable
from spacerobot.view.proof.batches import EARLIER, batches

ROOT = Path(__file__).parents[2]
RECORDS = ROOT / "docs" / "proof_records.jsonl"

pytestmark = pytest.mark.skipif(not RECORDS.exists(), reason="not in the source tree: the records are not installed")


QUOTED = ("in_set", "confidently_wrong", "coverage")
"""Rates that the README tells: those that say what an answer may not be believed for."""

MENDED = ROOT / "docs" / "proof_mended_records.jsonl"
AGAIN = ROOT / "docs" / "proof_again.md"


@pytest.fixture(scope="module")
def records() -> list[Record]:
    return list(read_batch(RECORDS)[1])


@pytest.mark.parametrize("path", [RECORDS, MENDED], ids=["proof", "mended"])
def test_every_rate_of_the_page_follows_from_the_records(path: Path) -> None:
    records: list[Record] = list(read_batch(path)[1])
    text = (ROOT / "docs" / f"{path.stem.removesuffix('_records')}.md").read_text(encoding="utf-8")
    assert f"{len(sealed(records))} sealed campaigns" in text
    for key, found in rates(records).items():
        assert str(found) in text, key
    wrong = [r for r in usable(records) if r["confidently_wrong"] and not r["same"]]
    for record in wrong:
        assert record["name"] in text


def test_every_batch_is_listed_those_of_earlier_notes_too() -> None:
    text = (ROOT / "docs" / "proof.md").read_text(encoding="utf-8")
    assert text.endswith(batches(ROOT / "docs"))
    earlier = tomllib.loads((ROOT / "docs" / EARLIER).read_text(encoding="utf-8"))["batch"]
    assert all(f"| {entry['date']} | {entry['seed']} |" in text for entry in earlier)
    for path in (RECORDS, MENDED):
        batch, records = read_batch(path)
        found = rates(list(records))["confidently_wrong"]
        (row,) = [line for line in text.splitlines() if f"`{path.name}` |" in line]
        assert str(batch["seed"]) in row
        assert f"| {len(usable(records))} | {found.hits} of {found.total} |" in row


def test_a_third_of_them_have_moving_joints_or_a_free_base(records: list[Record]) -> None:
    counted = sealed(records)
    assert sum(r["family"] in MOVES for r in counted) >= len(counted) / 3


def test_what_went_wrong_was_played_again(records: list[Record]) -> None:
    rows = [line.split("|") for line in AGAIN.read_text(encoding="utf-8").splitlines() if line.startswith("| ")][1:]
    said = {row[1].strip(): (row[4].strip(), row[-2].strip()) for row in rows}
    assert {name: then for name, (then, _) in said.items()} == {r["name"]: r["said"] for r in missed(records)}


def test_the_mended_codes_seed_was_drawn_after_it() -> None:
    """The second batch is of the code that the first one's misses were played again with, and of another seed."""
    batch, first = read_batch(MENDED)[0], read_batch(RECORDS)[0]
    assert batch["seed"] != first["seed"]
    assert all(code in AGAIN.read_text(encoding="utf-8") for code in batch["codes"].values())
    assert not set(batch["codes"].values()) & set(first["codes"].values())


def test_the_readme_quotes_the_latest_batch_and_leads_to_the_others() -> None:
    batch, found = read_batch(MENDED)
    text = re.sub(r"\s+", " ", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert f"seed {batch['seed']}" in text
    assert batch["date"] in text
    own = rates(list(found))
    for key in QUOTED:
        assert f"{own[key].hits} of {own[key].total}" in text, key
    for page in ("proof.md", "proof_mended.md", "proof_again.md"):
        assert f"(docs/{page})" in text
