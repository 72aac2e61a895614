"""What went wrong in a batch, played again with the code as it is today: `spacerobot prove --again`."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from spacerobot.proof.batch import run_batch
from spacerobot.proof.code_hash import code_hashes
from spacerobot.proof.orders import KINDS
from spacerobot.proof.published import check_orders, read_batch
from spacerobot.proof.summary import missed, right, usable
from spacerobot.support.executors.choose import executor
from spacerobot.support.files import write_text
from spacerobot.support.jsonio import dumps
from spacerobot.support.runs import RunFolder, combined_hash
from spacerobot.view.proof.again import page
from spacerobot.view.proof.prove import (
    in_words,
    orders_of,
    page_name,
    require_engine,
    require_minutes,
    seeds_in_words,
)

NAME = "proof_again"
"""Of the page, unless it is given another."""


def prove_again(
    records: str | Path,
    out: str | Path,
    *,
    minutes: float = math.inf,
    jobs: int = 1,
    dask: str | None = None,
    docs: str | Path | None = None,
    name: str = NAME,
    overwrite: bool = False,
    verbose: bool = False,
) -> dict[str, Any]:
    """Play the missed campaigns of a batch again, and write what is said of them now.

    Args:
        records: of the batch, a records.jsonl.
        out: folder for page and records; a finished run there is reused, an interrupted one goes on.
        minutes: after which no campaign is begun; the same call goes on with the others.
        jobs: campaigns at a time.
        dask: address of a Dask scheduler, whose workers play them, instead of `jobs`.
        docs: folder in which the page is published as well.
        name: of the page there.
        overwrite: replace another run that is in `out`.
        verbose: show progress although nobody watches.

    Returns:
        as in again.json; where nothing went wrong `{"wrong": 0}`, and nothing is written.

    Raises:
        InputError: MuJoCo is not installed, no such records, or `out` holds something else.
    """
    require_engine()
    require_minutes(minutes)
    file = f"{page_name(name)}.md"
    batch, every_record = read_batch(records)
    wrong = {r["name"]: r for r in missed(every_record)}
    if not wrong:
        return {"wrong": 0}
    every = orders_of(False, batch, list(KINDS), 1.0)
    check_orders([*wrong.values()], every, str(records))
    orders = [o for o in every if o.name in wrong]
    codes = code_hashes()
    key = combined_hash("prove again", batch["seed"], sorted(wrong))
    with RunFolder(out, "prove", key, overwrite=overwrite, code=" ".join(codes.values())) as folder:
        if not folder.finished:
            with executor(jobs, dask) as workers:
                played = run_batch(
                    folder, orders, workers=workers, rivals=False, verbose=verbose, seconds=60.0 * minutes
                )
            now = usable(played)  # one that cannot be made any more is not right for it
            about = {"seeds": seeds_in_words(batch), "then": in_words(batch["codes"]), "now": in_words(codes)}
            folder.write("again.md", page(every_record, now, about))
            told = {"wrong": len(wrong), "played": len(now), "right_now": sum(right(r) for r in now), "records": now}
            folder.write("again.json", dumps({**about, **told}) + "\n")
            if len(played) == len(orders):
                folder.finish()
        if docs is not None:
            write_text(Path(docs) / file, (folder.folder / "again.md").read_text(encoding="utf-8"))
        found: dict[str, Any] = json.loads((folder.folder / "again.json").read_text(encoding="utf-8"))
    return found
