"""The batches that were ever played, as Markdown: those whose records lie beside the page, and earlier ones."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from spacerobot.proof.published import read_batch
from spacerobot.proof.rates import Rate
from spacerobot.proof.summary import rates, usable
from spacerobot.support.errors import InputError
from spacerobot.view.proof.cells import table

EARLIER = "proof_batches.toml"
"""Batches whose records are not kept, in the folder of the pages."""

LARGE = 100
"""Campaigns from which on a batch has a line of its own."""

_HEAD = """\
## Earlier batches

What a batch shows is true of the code that it was played with; after a mend another seed was drawn. Those of less than
{large} campaigns, and those that were only played to find what falls short, are one line; each is listed in
`{earlier}`.
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
        large = [e for e in earlier if e["campaigns"] >= LARGE and "confidently_wrong" in e]
        small = [e for e in earlier if e not in large]
        rows = [_earlier(entry) for entry in large] + ([_small(small)] if small else [])
    except (tomllib.TOMLDecodeError, KeyError, TypeError, ValueError, UnicodeDecodeError) as error:
        raise InputError(f"no list of batches: {error}", where=str(path)) from None
    rows += [_published(path) for path in sorted(docs.glob("*_records.jsonl"))]
    head = ["date", "seed", "code", "campaigns", "confidently wrong", "in the set, from three limits on", ""]
    said = _HEAD.format(large=LARGE, earlier=EARLIER)
    return f"{said}\n{table(head, sorted(rows, key=lambda row: row[0]))}"


def _earlier(entry: Mapping[str, Any]) -> list[str]:
    optional = [str(entry.get(key, "-")) for key in ("code", "confidently_wrong", "in_set")]
    return [entry["date"], str(entry["seed"]), optional[0], str(entry["campaigns"]), *optional[1:], entry["became"]]


def _small(entries: Sequence[Mapping[str, Any]]) -> list[str]:
    """Many batches in one line."""
    dates = [e["date"] for e in entries]
    campaigns = sum(e["campaigns"] for e in entries)
    wrong, found = (_summed([e[key] for e in entries if key in e]) for key in ("confidently_wrong", "in_set"))
    said = f"{len(entries)} small ones and searches, to {max(dates)}"
    return [min(dates), "-", "-", str(campaigns), wrong, found, said]


def _summed(shares: Sequence[str]) -> str:
    """Of "2 of 37" and "0 of 3", "2 of 40"."""
    both = [share.split(" of ") for share in shares]
    return f"{sum(int(hits) for hits, _ in both)} of {sum(int(total) for _, total in both)}"


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
