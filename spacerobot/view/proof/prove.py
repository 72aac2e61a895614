"""Batches of sealed campaigns, from their seeds to their page: the front door of `spacerobot prove`."""

from __future__ import annotations

import importlib.util
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
from spacerobot.proof.labs import orders as labs
from spacerobot.proof.orders import FULL, KINDS, QUICK, Order, of_family, schedule
from spacerobot.proof.published import as_lines, changed, check_orders, read_batch, seed_of, still_valid
from spacerobot.proof.rates import Record
from spacerobot.proof.summary import SCENES, as_json
from spacerobot.proof.whole import orders as whole
from spacerobot.support.errors import InputError, NotFoundError
from spacerobot.support.executors.choose import executor
from spacerobot.support.files import atomic, write_text
from spacerobot.support.jsonio import dumps
from spacerobot.support.progress import say
from spacerobot.support.runs import RunFolder, combined_hash
from spacerobot.view.plotting import png
from spacerobot.view.proof.batches import batches
from spacerobot.view.proof.figures import FIGURES
from spacerobot.view.proof.page import page


def prove(
    out: str | Path,
    *,
    quick: bool = False,
    kinds: Sequence[str] | None = None,
    scenes: Sequence[str] | None = None,
    share: float = 1.0,
    minutes: float = math.inf,
    seed: int | None = None,
    resume: str | Path | None = None,
    jobs: int = 1,
    dask: str | None = None,
    rivals: bool = True,
    docs: str | Path | None = None,
    name: str = "proof",
    overwrite: bool = False,
    verbose: bool = False,
) -> dict[str, Any]:
    """Hide physics in another engine's recordings, diagnose them blind, and score, as `spacerobot prove` does.

    Args:
        out: folder for page, figures and records; a finished batch there is reused, an interrupted one goes on.
        quick: a handful of campaigns instead of all.
        kinds: of concealment, "_" for a blank; every one if None.
        scenes: rig, spinning, chaser, ...; every one if None.
        share: of each kind's campaigns, above 0, up to 1.
        minutes: after which no campaign is begun; the same call goes on with the others.
        seed: of the batch; drawn from the operating system if None.
        resume: records of a batch that is to be gone on with.
        jobs: campaigns at a time.
        dask: address of a Dask scheduler, whose workers play them, instead of `jobs`.
        rivals: whether mujoco.sysid, PySINDy and the bare refit are scored beside it.
        docs: folder in which page, figures and records are published as well.
        name: of the page there.
        overwrite: replace another run that is in `out`.
        verbose: show progress although nobody watches.

    Returns:
        the scores, as in proof.json.

    Raises:
        InputError: MuJoCo is not installed, a value that cannot be, or `out` holds something else.
    """
    require_engine()
    chosen = _some(kinds, KINDS, "kind of concealment", "--kinds")
    places = _some(scenes, SCENES, "scene", "--scenes")
    if not 0.0 < share <= 1.0:
        raise InputError("not a share", given=share, valid="above 0, up to 1", where="--share")
    require_minutes(minutes)
    name = page_name(name)
    codes = code_hashes()
    begun, known = _begun(resume, seed, codes)
    key = combined_hash("prove", quick, sorted(chosen), sorted(places), share, rivals, begun["seed"] if begun else seed)
    with RunFolder(out, "prove", key, overwrite=overwrite, code=" ".join(codes.values())) as folder:
        if not folder.finished:
            begun = folder.load("batch") or begun or _new(seed)
            folder.save("batch", begun)
            say(f"seed {seeds_in_words(begun)}, code {in_words(codes)}")
            orders = orders_of(quick, begun, chosen, share, places)
            _take_up(folder, orders, known, str(resume))
            with executor(jobs, dask) as workers:
                records = run_batch(
                    folder, orders, workers=workers, rivals=rivals, verbose=verbose, seconds=60.0 * minutes
                )
            about = {**begun, "command": _command(quick, kinds, scenes, share), "code": in_words(codes)}
            _write(folder, records, about, {**begun, "codes": codes}, len(orders))
        found: dict[str, Any] = json.loads((folder.folder / "proof.json").read_text(encoding="utf-8"))
        if docs is not None:
            batch, records = read_batch(folder.folder / "records.jsonl")
            publish(Path(docs), name, batch, records, found)
    return found


def require_engine() -> None:
    """Campaigns are made by MuJoCo.

    Raises:
        InputError: it is not installed.
    """
    if importlib.util.find_spec("mujoco") is None:
        raise InputError("MuJoCo is not installed", valid='pip install "spacerobot[proof]"')


def require_minutes(minutes: float) -> None:
    """A time within which campaigns may begin.

    Raises:
        InputError: it is none.
    """
    if not minutes > 0.0:
        raise InputError("not a time", given=minutes, valid="above 0", where="--minutes")


def _begun(
    path: str | Path | None, asked: int | None, codes: dict[str, str]
) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Seeds and dates, and the records, of the batch to go on with; nothing where a new one begins.

    Scenes whose code has changed since get a new seed: what was seen of the old one may be why it changed.
    """
    if path is None:
        return {}, []
    if asked is not None:
        raise InputError("the batch has its seed", given=f"--seed {asked}", valid="--resume without --seed")
    batch, records = read_batch(path)
    valid = still_valid(batch, records, codes, str(path))
    redrawn = batch.get("redrawn", {}) | {name: _new(None) for name in changed(batch, codes)}
    if len(valid) < len(records):
        say(f"{len(records) - len(valid)} campaigns were diagnosed by other code; others are played, from a new seed")
    begun = {"seed": batch["seed"], "date": batch["date"]}
    return (begun | {"redrawn": redrawn} if redrawn else begun), valid


def _new(asked: int | None) -> dict[str, Any]:
    return {"seed": draw_seed() if asked is None else asked, "date": datetime.now(UTC).strftime("%Y-%m-%d")}


def _take_up(folder: RunFolder, orders: list[Order], known: list[dict[str, Any]], path: str) -> None:
    """Keep the records of a published batch as this folder's own, where it has none yet."""
    check_orders(known, orders, path)
    for record in known:
        if folder.load(record["name"]) is None:
            folder.save(record["name"], record)


def _write(
    folder: RunFolder,
    records: list[dict[str, Any]],
    begun: Mapping[str, Any],
    batch: Mapping[str, Any],
    planned: int,
) -> None:
    """Page, figures, records and scores; finished where all that was planned is played."""
    about = {**begun, "version": __version__, "seeds": seeds_in_words(begun), "planned": planned}
    drawn = figures_of(records)
    for name, picture in drawn.items():
        folder.write(name, picture)
    folder.write("proof.md", page(records, about, {Path(n).stem.removeprefix("proof_"): n for n in drawn}))
    folder.write("records.jsonl", as_lines(batch, records))
    folder.write("proof.json", dumps(as_json(records, about)) + "\n")
    if len(records) == planned:
        folder.finish()
    else:
        say(f"{len(records)} of {planned} campaigns played; the same command goes on with the others")


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
    for own in (driven, labs, whole):
        counts = {kind: some(count) for kind, count in (own.QUICK if quick else own.FULL).items()}
        every += of_family(own.FAMILY, counts, seed_of(batch, group(own.FAMILY)))
    orders = [o for o in every if o.kind in kinds and o.family in scenes]
    if not orders:
        raise InputError(
            "this batch has no campaign of these kinds in these scenes", given=" ".join(kinds), where="--kinds"
        )
    return orders


def _some(given: Sequence[str] | None, every: Iterable[str], what: str, where: str) -> list[str]:
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


def _command(quick: bool, kinds: Sequence[str] | None, scenes: Sequence[str] | None, share: float) -> str:
    words = ["spacerobot prove", "--quick" if quick else ""]
    words += [f"--kinds {' '.join(kinds)}" if kinds else "", f"--scenes {' '.join(scenes)}" if scenes else ""]
    words.append(f"--share {share:g}" if share != 1.0 else "")
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
