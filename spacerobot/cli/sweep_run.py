"""The work of `spacerobot sweep`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from spacerobot.support.executors.choose import not_both
from spacerobot.support.jsonio import dumps
from spacerobot.support.numbers import parse_whole
from spacerobot.sweep.run import run_sweep


def run(args: argparse.Namespace) -> int:
    """Make the parts that are missing, and say what came of it."""
    not_both(args.jobs, args.dask)
    jobs = 1 if args.jobs is None else parse_whole(args.jobs, "--jobs", least=1, most=4096)
    asked = None if args.seed is None else parse_whole(args.seed, "--seed")
    answer = run_sweep(
        args.sweep, args.out, jobs=jobs, dask=args.dask, seed=asked, overwrite=args.overwrite, verbose=args.verbose
    )
    print(dumps(answer) if args.json else _told(answer, Path(args.out)))
    return 0


def _told(answer: dict[str, Any], folder: Path) -> str:
    lines = [
        f"{answer['collisions']} collisions, {answer['parts']} parts, seed {answer['seed']}, {answer['method']}",
        "",
        f"{'':24s} {'defined':>12s} {'mean':>12s} {'least':>12s} {'largest':>12s}",
    ]
    for name, found in answer["results"].items():
        numbers = "".join(
            f" {'-' if found[k] is None else format(found[k], '.6g'):>12s}" for k in ("mean", "min", "max")
        )
        lines.append(f"{name:24s} {found['count']:12d}{numbers}")
    notes = [f"note: {text}" for text in answer["notes"]]
    return "\n".join([*lines, "", f"table: {folder}/collisions", *notes])
