"""The work of `spacerobot sweep`."""

from __future__ import annotations

import argparse
import importlib.util
import json
from pathlib import Path
from typing import Any

from spacerobot.simulation.scene_file import scene_text
from spacerobot.support.errors import InputError
from spacerobot.support.executors.choose import executor, not_both
from spacerobot.support.numbers import parse_whole
from spacerobot.support.runs import RunFolder, combined_hash
from spacerobot.sweep.sweep_file import plan_from_text, read_sweep


def run(args: argparse.Namespace) -> int:
    """Make the parts that are missing, and say what came of it."""
    if importlib.util.find_spec("pyarrow") is None:
        raise InputError("pyarrow is not installed", valid='pip install "spacerobot[scale]"')
    from spacerobot.sweep.campaign import Job, run_sweep

    not_both(args.jobs, args.dask)
    jobs = 1 if args.jobs is None else parse_whole(args.jobs, "--jobs", least=1, most=4096)
    asked = None if args.seed is None else parse_whole(args.seed, "--seed")
    text, base = read_sweep(args.sweep), Path(args.sweep).resolve().parent
    plan = plan_from_text(text, base, seed=asked, where=args.sweep)
    key = combined_hash("sweep", text, scene_text(plan.scene), plan.poses, plan.seed)
    with RunFolder(args.out, "sweep", key, overwrite=args.overwrite) as folder:
        if not folder.finished:
            job = Job(text, str(base), plan.seed, str(folder.folder), key)
            with executor(jobs, args.dask) as workers:
                run_sweep(folder, job, plan, workers, verbose=args.verbose)
            folder.finish()
        answer = (folder.folder / "sweep.json").read_text(encoding="utf-8")
        print(answer.rstrip("\n") if args.json else _told(json.loads(answer), folder.folder))
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
