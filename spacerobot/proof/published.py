"""The records of a batch as one file beside its page: one JSON object a line, whence the batch goes on elsewhere."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from spacerobot.proof.code_hash import group
from spacerobot.proof.orders import Order
from spacerobot.support.errors import InputError
from spacerobot.support.formats import require_format
from spacerobot.support.jsonio import dumps

FORMAT = 1

SCORED = ("said", "expected", "hidden", "favourite", "strength", "confidence", "parameters", "seconds", "same", "equal")
"""Keys without which a record of a campaign that was made is none."""


def as_lines(batch: Mapping[str, Any], records: Sequence[Mapping[str, Any]]) -> str:
    """The file's text: the batch (seed, date, codes) first, then each record."""
    return "".join(f"{dumps(line, indent=None)}\n" for line in ({"format": FORMAT, **batch}, *records))


def read_batch(path: str | Path) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Batch and records of such a file.

    Raises:
        InputError: no such file, or a line that is none of it.
    """
    lines = _lines(Path(path))
    where, first = next(lines, ("", {}))
    if "format" not in first:
        raise InputError("not the records of a batch", given=str(path), valid="a records.jsonl of `spacerobot prove`")
    require_format(first["format"], FORMAT, "batch's records", where)
    for key, kind in (("seed", int), ("date", str), ("codes", dict)):
        if not isinstance(first.get(key), kind):
            raise InputError(f"the batch states no {key}", given=first.get(key), where=where)
    redrawn = _redrawn(first.get("redrawn", {}), where)
    batch = {"seed": first["seed"], "date": first["date"], **({"redrawn": redrawn} if redrawn else {})}
    return {**batch, "codes": first["codes"]}, [_scored(record, where) for where, record in lines]


def changed(batch: Mapping[str, Any], codes: Mapping[str, str]) -> list[str]:
    """The groups of scenes whose code is not the one that a batch was played with."""
    return [name for name, code in codes.items() if batch["codes"].get(name) != code]


def still_valid(
    batch: Mapping[str, Any], records: Sequence[dict[str, Any]], codes: Mapping[str, str], where: str
) -> list[dict[str, Any]]:
    """The records of campaigns that depend on no source that has changed since.

    Raises:
        InputError: there is none.
    """
    same = codes.keys() - changed(batch, codes)
    if not same:
        raise InputError(
            "these campaigns were diagnosed by other code; they do not count in this batch",
            given=where,
            valid="a new batch, without --resume",
        )
    return [r for r in records if group(str(r.get("family"))) in same]


def seed_of(batch: Mapping[str, Any], name: str) -> int:
    """The seed of a group of scenes: the batch's, or the one drawn after the code of that group had changed."""
    return int(batch.get("redrawn", {}).get(name, batch)["seed"])


def check_orders(records: Sequence[Mapping[str, Any]], orders: Sequence[Order], where: str) -> None:
    """Check that every record is of a campaign of the batch.

    Raises:
        InputError: one is of another campaign, or of one with another seed.
    """
    seeds = {o.name: o.seed for o in orders}
    for record in records:
        if seeds.get(record["name"]) != record["seed"]:
            raise InputError("this record is of no campaign of the batch", given=record["name"], where=where)


def _redrawn(given: Any, where: str) -> dict[str, dict[str, Any]]:
    if not isinstance(given, dict) or not all(
        isinstance(g, dict) and isinstance(g.get("seed"), int) and isinstance(g.get("date"), str)
        for g in given.values()
    ):
        raise InputError(
            "the batch's seeds that were drawn anew are none",
            given=str(given)[:60],
            valid="group of scenes -> seed and date",
            where=where,
        )
    return given


def _lines(path: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise InputError("the records cannot be read", given=str(path), where="--resume") from error
    for number, line in enumerate(text.split("\n"), 1):  # `splitlines` knows other ends, which texts may hold
        if not line:
            continue
        where = f"{path}, line {number}"
        try:
            found = json.loads(line)
        except (ValueError, RecursionError):
            raise InputError("not a line of JSON", given=line[:60], where=where) from None
        if not isinstance(found, dict):
            raise InputError("not a JSON object", given=line[:60], where=where)
        yield where, found


def _scored(record: dict[str, Any], where: str) -> dict[str, Any]:
    if not isinstance(record.get("name"), str) or not isinstance(record.get("seed"), int):
        raise InputError("a record without name and seed", given=str(record.get("name"))[:60], where=where)
    missing = [key for key in SCORED if key not in record]
    if missing and "failed" not in record:
        raise InputError(f"the record lacks {', '.join(missing)}", given=record["name"], where=where)
    return record
