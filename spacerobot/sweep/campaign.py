"""A sweep run on an executor: parts that are there are kept, the others made, the whole counted at the end."""

from __future__ import annotations

import functools
import math
import os
import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot import __version__
from spacerobot.support.errors import InputError, SpacerobotError
from spacerobot.support.executors.base import Executor
from spacerobot.support.executors.cluster import DaskWorkers
from spacerobot.support.jsonio import dumps
from spacerobot.support.progress import Progress
from spacerobot.support.runs import RunFolder
from spacerobot.sweep.engine import RESULTS, Engine
from spacerobot.sweep.parts import footer_of, part_name, write_part, write_table
from spacerobot.sweep.plan import Plan
from spacerobot.sweep.sweep_file import plan_from_text


@dataclass(frozen=True)
class Job:
    """What is the same for all parts, as it travels to a worker.

    Attributes:
        text, base: of the sweep file, and the folder that its paths are relative to.
        seed: of the sweep.
        folder: of the run.
        input_hash: of the run; every part carries it.
    """

    text: str
    base: str
    seed: int
    folder: str
    input_hash: str


@dataclass(frozen=True)
class Part:
    """One task: a file to write."""

    job: Job
    number: int


def make_part(part: Part) -> dict[str, Any]:
    """In a worker: compute and write a part; returns its footer. Doing it twice writes the same file again."""
    engine = _engine(part.job)
    first, last = engine.plan.range_of(part.number)
    path = Path(part.job.folder) / part_name(part.number)
    return write_part(path, engine.columns(first, last), _about(part.job, part.number, first, last))


def make_parts(run: RunFolder, job: Job, plan: Plan, executor: Executor, *, verbose: bool = False) -> dict[str, Any]:
    """Make every part that is not there yet; returns the summary, also written as sweep.json.

    Raises:
        InputError: workers do not see the folder, or a collision cannot be.
        SpacerobotError: workers die again and again, or a part is not what it should be at the end.
    """
    run.paths([part_name(i) for i in range(plan.parts)])
    if isinstance(executor, DaskWorkers):
        _require_shared(run.folder, executor)
    done = [i for i in range(plan.parts) if _footer(run.folder, job, plan, i) is not None]
    todo = sorted(set(range(plan.parts)) - set(done))
    with Progress("colliding", plan.total, unit="collision", verbose=verbose) as progress:
        progress.advance(sum(_rows(plan, i) for i in done))
        for part, footer in executor.run(make_part, (Part(job, i) for i in todo)):
            progress.advance(footer["rows"], note=f"part {part.number + 1} of {plan.parts}")
    return _finished(run, job, plan)


def _finished(run: RunFolder, job: Job, plan: Plan) -> dict[str, Any]:
    """Count what is there, write poses and summary."""
    totals = {name: _Total() for name in RESULTS.values()}
    rows = 0
    for i in range(plan.parts):
        footer = _footer(run.folder, job, plan, i)
        if footer is None:
            raise SpacerobotError(f"{part_name(i)} is not there or not whole, although it was written")
        rows += footer["rows"]
        for name, total in totals.items():
            total.add(footer["results"][name])
    assert rows == plan.total  # every footer's range was compared with the plan's
    chain = plan.scene.prepared.chain
    poses = np.array(plan.poses, dtype=float).reshape(len(plan.poses), len(chain))
    columns = {"pose": np.arange(len(poses), dtype=np.int32), **{j: poses[:, i] for i, j in enumerate(chain)}}
    write_table(run.path("poses.parquet"), columns, {"input_hash": job.input_hash})
    summary = {
        "format": 1,
        "spacerobot": __version__,
        "title": plan.title,
        "input_hash": job.input_hash,
        "seed": plan.seed,
        "collisions": plan.total,
        "parts": plan.parts,
        "poses": len(plan.poses),
        "grid": {key: len(values) for key, values in plan.grid.items()},
        "scatter": list(plan.scatter),
        "repeats": plan.repeats,
        "method": _engine(job).method,
        "notes": list(plan.scene.notes),
        "results": {name: total.as_json() for name, total in totals.items()},
    }
    run.write("sweep.toml", job.text)
    run.write("sweep.json", dumps(summary) + "\n")
    return summary


class _Total:
    """Count, mean, least and largest of a result over all parts, whatever the order in which they were made."""

    def __init__(self) -> None:
        self.count, self.sums = 0, [0.0]
        self.least, self.largest = math.inf, -math.inf

    def add(self, part: dict[str, Any]) -> None:
        if part["count"]:
            self.count += part["count"]
            self.sums.append(part["sum"])
            self.least, self.largest = min(self.least, part["min"]), max(self.largest, part["max"])

    def as_json(self) -> dict[str, Any]:
        if not self.count:
            return {"count": 0, "mean": None, "min": None, "max": None}
        mean = math.fsum(self.sums) / self.count
        return {"count": self.count, "mean": mean, "min": self.least, "max": self.largest}


@functools.lru_cache(maxsize=2)
def _engine(job: Job) -> Engine:
    return Engine(plan_from_text(job.text, Path(job.base), seed=job.seed))


def _about(job: Job, number: int, first: int, last: int) -> dict[str, Any]:
    return {"input_hash": job.input_hash, "part": number, "first": first, "rows": last - first}


def _footer(folder: Path, job: Job, plan: Plan, number: int) -> dict[str, Any] | None:
    """The footer of a part that is there, whole, and this run's; else None."""
    footer = footer_of(folder / part_name(number))
    wanted = _about(job, number, *plan.range_of(number))
    if footer is None or any(footer.get(key) != value for key, value in wanted.items()):
        return None
    return footer


def _rows(plan: Plan, number: int) -> int:
    first, last = plan.range_of(number)
    return last - first


def _require_shared(folder: Path, executor: DaskWorkers) -> None:
    """Workers write the parts themselves, so they must see the folder."""
    with _token(folder) as (path, text):
        blind = [worker for worker, seen in executor.everywhere(_sees, str(path), text).items() if not seen]
    if blind:
        raise InputError(
            f"{len(blind)} Dask worker(s) do not see the folder of the results",
            given=str(folder),
            valid="a folder on a file system that all workers share",
            where="--out",
        )


class _token:
    """A file that says something nobody could guess, for as long as the block lasts."""

    def __init__(self, folder: Path) -> None:
        self.path, self.text = folder / f".shared.{os.getpid()}.part", secrets.token_hex(16)

    def __enter__(self) -> tuple[Path, str]:
        self.path.write_text(self.text, encoding="utf-8")
        return self.path, self.text

    def __exit__(self, *_: object) -> None:
        self.path.unlink(missing_ok=True)


def _sees(path: str, text: str) -> bool:
    """In a worker: whether the file is there."""
    try:
        return Path(path).read_text(encoding="utf-8") == text
    except OSError:
        return False
