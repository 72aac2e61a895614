"""The work of `spacerobot prove --again`: what went wrong in a batch, with the code as it is today."""

from __future__ import annotations

import argparse
from pathlib import Path

from spacerobot.cli.prove_run import in_words, jobs_and_minutes, orders_of, page_name, seeds_in_words
from spacerobot.proof.batch import run_batch
from spacerobot.proof.code_hash import code_hashes
from spacerobot.proof.orders import KINDS
from spacerobot.proof.published import check_orders, read_batch
from spacerobot.proof.summary import missed, right, usable
from spacerobot.support.errors import InputError
from spacerobot.support.executors.choose import executor
from spacerobot.support.files import write_text
from spacerobot.support.jsonio import dumps
from spacerobot.support.progress import say
from spacerobot.support.runs import RunFolder, combined_hash
from spacerobot.view.proof.again import page

NAME = "proof_again"
"""Of the page, unless it is given another."""

_ELSE = ("resume", "seed", "quick", "kinds", "scenes")
"""Arguments that choose what is played; here the records do."""


def run_again(args: argparse.Namespace) -> int:
    """Play the missed campaigns of a batch again, and write what is said of them now."""
    for name in _ELSE:
        if getattr(args, name):
            raise InputError("what is played again is chosen by the records", given=f"--{name}", valid="--again alone")
    jobs, minutes = jobs_and_minutes(args)
    name = f"{page_name(args.page or NAME)}.md"
    batch, records = read_batch(args.again)
    wrong = {r["name"]: r for r in missed(records)}
    if not wrong:
        say("nothing went wrong in this batch")
        return 0
    every = orders_of(False, batch, list(KINDS), 1.0)
    check_orders([*wrong.values()], every, args.again)
    orders = [o for o in every if o.name in wrong]
    codes = code_hashes()
    key = combined_hash("prove again", batch["seed"], sorted(wrong))
    with RunFolder(args.out, "prove", key, overwrite=args.overwrite, code=" ".join(codes.values())) as folder:
        if not folder.finished:
            with executor(jobs, args.dask) as workers:
                played = run_batch(
                    folder, orders, workers=workers, rivals=False, verbose=args.verbose, seconds=60.0 * minutes
                )
            now = usable(played)  # one that cannot be made any more is not right for it
            about = {"seeds": seeds_in_words(batch), "then": in_words(batch["codes"]), "now": in_words(codes)}
            folder.write("again.md", page(records, now, about))
            told = {"wrong": len(wrong), "played": len(now), "right_now": sum(right(r) for r in now), "records": now}
            folder.write("again.json", dumps({**about, **told}) + "\n")
            if len(played) == len(orders):
                folder.finish()
        text = (folder.folder / "again.md").read_text(encoding="utf-8")
        if args.docs:
            write_text(Path(args.docs) / name, text)
        print((folder.folder / "again.json").read_text(encoding="utf-8").rstrip("\n") if args.json else text)
    return 0
