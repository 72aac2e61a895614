"""The work of `spacerobot prove`."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

from spacerobot.support.errors import InputError
from spacerobot.support.executors.choose import not_both
from spacerobot.support.jsonio import dumps
from spacerobot.support.numbers import parse_numbers, parse_whole
from spacerobot.support.progress import say
from spacerobot.view.proof.prove import prove, require_minutes
from spacerobot.view.proof.prove_again import prove_again

_ELSE = ("resume", "seed", "quick", "kinds", "scenes")
"""Arguments that choose what is played; with --again the records do."""


def run(args: argparse.Namespace) -> int:
    """Play a batch, what is left of it, or what went wrong in it, and print what came of it."""
    return _batch(args) if args.again is None else _again(args)


def _batch(args: argparse.Namespace) -> int:
    jobs, minutes = _jobs_and_minutes(args)
    answer = prove(
        args.out,
        quick=args.quick,
        kinds=args.kinds,
        scenes=args.scenes,
        share=parse_numbers([args.share], "--share", count=1)[0],
        minutes=minutes,
        seed=None if args.seed is None else parse_whole(args.seed, "--seed"),
        resume=args.resume,
        jobs=jobs,
        dask=args.dask,
        rivals=not args.no_rivals,
        docs=args.docs,
        name=args.page or "proof",
        overwrite=args.overwrite,
        verbose=args.verbose,
    )
    print(dumps(answer) if args.json else _told(answer, Path(args.out)))
    return 0


def _again(args: argparse.Namespace) -> int:
    for name in _ELSE:
        if getattr(args, name):
            raise InputError("what is played again is chosen by the records", given=f"--{name}", valid="--again alone")
    jobs, minutes = _jobs_and_minutes(args)
    given = {"name": args.page} if args.page else {}
    answer = prove_again(
        args.again,
        args.out,
        minutes=minutes,
        jobs=jobs,
        dask=args.dask,
        docs=args.docs,
        overwrite=args.overwrite,
        verbose=args.verbose,
        **given,
    )
    if not answer["wrong"]:
        say("nothing went wrong in this batch")
    else:
        print(dumps(answer) if args.json else (Path(args.out) / "again.md").read_text(encoding="utf-8"))
    return 0


def _jobs_and_minutes(args: argparse.Namespace) -> tuple[int, float]:
    """How many campaigns at a time, and for how long.

    Raises:
        InputError: neither a number of jobs nor a time, or jobs where a cluster is to play.
    """
    not_both(args.jobs, args.dask)
    jobs = 1 if args.jobs is None else parse_whole(args.jobs, "--jobs", least=1)
    minutes = math.inf if args.minutes is None else parse_numbers([args.minutes], "--minutes", count=1)[0]
    require_minutes(minutes)
    return jobs, minutes


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
