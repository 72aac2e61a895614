"""Every batch that was ever played, as Markdown: those whose records lie beside the page, and earlier ones."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from spacerobot.proof.published import read_batch
from spacerobot.proof.rates import Rate
from spacerobot.proof.summary import rates, usable
from spacerobot.support.errors import InputError
from spacerobot.view.proof.cells import table

EARLIER = "proof_batches.toml"
"""Batches whose records are not kept, in the folder of the pages."""

_HEAD = """\
## Every batch

Small ones, and those that were only played to find what falls short, too. What a batch shows is true of the code that
it was played with; after a mend another seed was drawn.
"""


def batches(docs: Path) -> str:
    """The section of a folder of pages; empty where it lists no earlier batch.

    Raises:
        InputError: the list of earlier batches, or a file of records, is none.
    """
    path = docs / EARLIER
    if not path.exists():
        return ""
    try:
        earlier = tomllib.loads(path.read_text(encoding="utf-8"))["batch"]
        rows = [_earlier(entry) for entry in earlier]
    except (tomllib.TOMLDecodeError, KeyError, TypeError, UnicodeDecodeError) as error:
        raise InputError(f"no list of batches: {error}", where=str(path)) from None
    rows += [_published(path) for path in sorted(docs.glob("*_records.jsonl"))]
    head = ["date", "seed", "code", "campaigns", "confidently wrong", "in the set, from three limits on", ""]
    return f"{_HEAD}\n{table(head, sorted(rows, key=lambda row: row[0]))}"


def _earlier(entry: Mapping[str, Any]) -> list[str]:
    optional = [str(entry.get(key, "-")) for key in ("code", "confidently_wrong", "in_set")]
    return [entry["date"], str(entry["seed"]), optional[0], str(entry["campaigns"]), *optional[1:], entry["became"]]


def _published(path: Path) -> list[str]:
    batch, records = read_batch(path)
    found = rates(list(records))
    seeds = [str(batch["seed"]), *(f"{name}: {new['seed']}" for name, new in batch.get("redrawn", {}).items())]
    return [
        batch["date"],
        ", ".join(seeds),
        ", ".join(batch["codes"].values()),
        str(len(usable(records))),
        _of(found["confidently_wrong"]),
        _of(found["in_set"]),
        f"published: `{path.name}`",
    ]


def _of(found: Rate) -> str:
    return f"{found.hits} of {found.total}"
