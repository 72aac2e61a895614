"""The work of `spacerobot prove`."""

from __future__ import annotations

import argparse
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from spacerobot import __version__
from spacerobot.proof.batch import draw_seed, run_batch
from spacerobot.proof.code_hash import WRIST, code_hashes, group
from spacerobot.proof.driven import orders as driven
from spacerobot.proof.orders import FULL, KINDS, QUICK, Order, of_family, schedule
from spacerobot.proof.published import as_lines, changed, check_orders, read_batch, seed_of, still_valid
from spacerobot.proof.rates import Record
from spacerobot.proof.summary import SCENES, as_json
from spacerobot.proof.whole import orders as whole
from spacerobot.support.errors import InputError, NotFoundError
from spacerobot.support.executors.choose import executor, not_both
from spacerobot.support.files import atomic, write_text
from spacerobot.support.jsonio import dumps
from spacerobot.support.numbers import parse_numbers, parse_whole
from spacerobot.support.progress import say
from spacerobot.support.runs import RunFolder, combined_hash
from spacerobot.view.plotting import png
from spacerobot.view.proof.batches import batches
from spacerobot.view.proof.figures import FIGURES
from spacerobot.view.proof.page import page


def run_batches(args: argparse.Namespace) -> int:
    """Play the batch, or what is left of it, and write its page."""
    kinds = _some(args.kinds, KINDS, "kind of concealment", "--kinds")
    scenes = _some(args.scenes, SCENES, "scene", "--scenes")
    share = parse_numbers([args.share], "--share", count=1)[0]
    if not 0.0 < share <= 1.0:
        raise InputError("not a share", given=share, valid="above 0, up to 1", where="--share")
    jobs, minutes = jobs_and_minutes(args)
    asked = None if args.seed is None else parse_whole(args.seed, "--seed")
    name = page_name(args.page or "proof")
    codes = code_hashes()
    begun, known = _begun(args.resume, asked, codes)
    seed = begun["seed"] if begun else asked
    key = combined_hash("prove", args.quick, sorted(kinds), sorted(scenes), share, not args.no_rivals, seed)
    with RunFolder(args.out, "prove", key, overwrite=args.overwrite, code=" ".join(codes.values())) as folder:
        if not folder.finished:
            begun = folder.load("batch") or begun or _new(asked)
            folder.save("batch", begun)
            say(f"seed {seeds_in_words(begun)}, code {in_words(codes)}")
            orders = orders_of(args.quick, begun, kinds, share, scenes)
            _take_up(folder, orders, known, args.resume)
            _play(folder, args, orders, begun, jobs, codes, minutes)
        text = (folder.folder / "proof.json").read_text(encoding="utf-8")
        if args.docs:
            run = folder.folder
            batch, records = read_batch(run / "records.jsonl")
            publish(Path(args.docs), name, batch, records, json.loads(text))
        print(text.rstrip("\n") if args.json else _told(json.loads(text), folder.folder))
    return 0


def jobs_and_minutes(args: argparse.Namespace) -> tuple[int, float]:
    """How many campaigns at a time, and for how long.

    Raises:
        InputError: neither a number of jobs nor a time, or jobs where a cluster is to play.
    """
    not_both(args.jobs, args.dask)
    jobs = 1 if args.jobs is None else parse_whole(args.jobs, "--jobs", least=1)
    minutes = parse_numbers([args.minutes], "--minutes", count=1)[0] if args.minutes is not None else math.inf
    if minutes <= 0.0:
        raise InputError("not a time", given=minutes, valid="above 0", where="--minutes")
    return jobs, minutes


def _begun(path: str | None, asked: int | None, codes: dict[str, str]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Seeds and dates, and the records, of the batch to go on with; nothing where a new one begins.

    Scenes whose code has changed since get a new seed: what was seen of the old one may be why it changed.
    """
    if path is None:
        return {}, []
    if asked is not None:
        raise InputError("the batch has its seed", given=f"--seed {asked}", valid="--resume without --seed")
    batch, records = read_batch(path)
    valid = still_valid(batch, records, codes, path)
    redrawn = batch.get("redrawn", {}) | {name: _new(None) for name in changed(batch, codes)}
    if len(valid) < len(records):
        say(f"{len(records) - len(valid)} campaigns were diagnosed by other code; others are played, from a new seed")
    begun = {"seed": batch["seed"], "date": batch["date"]}
    return (begun | {"redrawn": redrawn} if redrawn else begun), valid


def _new(asked: int | None) -> dict[str, Any]:
    return {"seed": draw_seed() if asked is None else asked, "date": datetime.now(UTC).strftime("%Y-%m-%d")}


def _take_up(folder: RunFolder, orders: list[Order], known: list[dict[str, Any]], path: str | None) -> None:
    """Keep the records of a published batch as this folder's own, where it has none yet."""
    check_orders(known, orders, str(path))
    for record in known:
        if folder.load(record["name"]) is None:
            folder.save(record["name"], record)


def _play(
    folder: RunFolder,
    args: argparse.Namespace,
    orders: list[Order],
    begun: dict[str, Any],
    jobs: int,
    codes: dict[str, str],
    minutes: float,
) -> None:
    with executor(jobs, args.dask) as workers:
        records = run_batch(
            folder, orders, workers=workers, rivals=not args.no_rivals, verbose=args.verbose, seconds=60.0 * minutes
        )
    about: dict[str, Any] = {**begun, "version": __version__, "code": in_words(codes), "command": _command(args)}
    about["seeds"] = seeds_in_words(begun)
    about["planned"] = len(orders)
    drawn = figures_of(records)
    for name, picture in drawn.items():
        folder.write(name, picture)
    folder.write("proof.md", page(records, about, {Path(n).stem.removeprefix("proof_"): n for n in drawn}))
    folder.write("records.jsonl", as_lines({**begun, "codes": codes}, records))
    folder.write("proof.json", dumps(as_json(records, about)) + "\n")
    if len(records) == len(orders):
        folder.finish()
    else:
        say(f"{len(records)} of {len(orders)} campaigns played; the same command goes on with the others")


def in_words(codes: dict[str, str]) -> str:
    """The codes of a batch as the page and the command tell them."""
    return ", ".join(f"{code} ({name})" for name, code in codes.items())


def seeds_in_words(batch: Mapping[str, Any]) -> str:
    """The seeds of a batch as the page and the command tell them."""
    own = [f"{name}: {new['seed']}, {new['date']}" for name, new in batch.get("redrawn", {}).items()]
    return f"{batch['seed']}, {batch['date']}" + (f" ({'; '.join(own)})" if own else "")


def orders_of(
    quick: bool, batch: Mapping[str, Any], kinds: Sequence[str], share: float, scenes: Sequence[str] = tuple(SCENES)
) -> list[Order]:
    """The campaigns of a batch, from its seeds."""
    size = QUICK if quick else FULL

    def some(count: int) -> int:
        return count and max(1, round(share * count))

    smaller = replace(
        size,
        counts={kind: some(count) for kind, count in size.counts.items()},
        curve_repeats=some(size.curve_repeats),
        short_repeats=some(size.short_repeats),
        withheld_rounds=some(size.withheld_rounds),
    )
    every = schedule(smaller, seed_of(batch, WRIST))
    for own in (driven, whole):
        counts = {kind: some(count) for kind, count in (own.QUICK if quick else own.FULL).items()}
        every += of_family(own.FAMILY, counts, seed_of(batch, group(own.FAMILY)))
    orders = [o for o in every if o.kind in kinds and o.family in scenes]
    if not orders:
        raise InputError(
            "this batch has no campaign of these kinds in these scenes", given=" ".join(kinds), where="--kinds"
        )
    return orders


def _some(given: list[str] | None, every: Iterable[str], what: str, where: str) -> list[str]:
    if given is None:
        return list(every)
    known = {k.replace(" ", "_"): k for k in every}
    found = []
    for token in (t for text in given for t in text.split(",") if t):
        name = token.replace(" ", "_")
        if name not in known:
            raise NotFoundError(what, token, known, where=where)
        found.append(known[name])
    return list(dict.fromkeys(found))


def _command(args: argparse.Namespace) -> str:
    words = ["spacerobot prove", "--quick" if args.quick else ""]
    words += [
        f"--kinds {' '.join(args.kinds)}" if args.kinds else "",
        f"--scenes {' '.join(args.scenes)}" if args.scenes else "",
        f"--share {args.share}" if args.share != "1" else "",
    ]
    return " ".join(w for w in words if w)


def page_name(given: str) -> str:
    """A name that a page and its files may have, as it was given."""
    if not re.fullmatch(r"[a-z0-9_]{1,40}", given):
        raise InputError("not a page's name", given=given[:60], valid="letters a to z, digits, _", where="--page")
    return given


def figures_of(records: Sequence[Record]) -> dict[str, bytes]:
    """The page's figures: path beside it -> PNG."""
    drawn = {name: draw(records) for name, draw in FIGURES.items()}
    return {f"figures/proof_{name}.png": png(figure) for name, figure in drawn.items() if figure is not None}


def publish(
    docs: Path, name: str, batch: Mapping[str, Any], records: Sequence[Record], about: Mapping[str, Any]
) -> None:
    """Page, figures and records of a batch under the page's name, by which they know each other.

    Args:
        docs: folder of the pages; one that lists earlier batches has them all listed in the page "proof".
        name: of the page.
        batch: seeds, date and codes.
        records: of the batch.
        about: what the page says of it, see `view.proof.page`.
    """
    drawn = figures_of(records)
    text = page(records, about, {Path(n).stem.removeprefix("proof_"): n for n in drawn})
    for ours, called in (("proof_records.jsonl", f"{name}_records.jsonl"), ("figures/proof_", f"figures/{name}_")):
        text = text.replace(ours, called)
    if name != "proof":
        text = text.replace("--docs docs`", f"--docs docs --page {name}`")
    write_text(docs / f"{name}_records.jsonl", as_lines(batch, records))
    if name == "proof" and (every := batches(docs)):
        text = f"{text}\n{every}"
    write_text(docs / f"{name}.md", text)
    for path, picture in drawn.items():
        with atomic(docs / "figures" / f"{name}{Path(path).name.removeprefix('proof')}", "wb") as stream:
            stream.write(picture)


def _told(answer: dict[str, Any], folder: Path) -> str:
    left = answer["planned"] - answer["played"]
    part = f", {left} more to play" if left else ""
    lines = [f"{answer['campaigns']} sealed campaigns, seed {answer['seed']}, {answer['date']}{part}"]
    for key, found in answer["targets"].items():
        if "hits" in found:
            low, high = found["clopper_pearson_95"]
            value = f"{found['hits']} of {found['campaigns']}, {100 * low:.0f} to {100 * high:.0f} %"
        else:
            point = found["median"] if "median" in found else found["error"]
            value = "-" if point is None else f"{point:.3f}"
        reached = {None: "open", True: "reached", False: "not reached"}[found["met"]]
        reached = reached if found.get("campaigns", 1) else ""
        lines.append(f"  {key:20s} {value:28s} {reached}".rstrip())
    return "\n".join([*lines, f"page: {folder}/proof.md"])
