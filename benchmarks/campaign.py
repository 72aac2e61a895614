"""What a sweep costs: per collision, per part, per task of an executor; and a paper estimate of 10^9 collisions."""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.swept import RIGS, engine_of, on_workers, workers_table
from benchmarks.timing import as_json, costs
from spacerobot.simulation.exact.batch import collide
from spacerobot.support.executors.base import Executor
from spacerobot.support.executors.local import LocalPool
from spacerobot.sweep.parts import write_part

NAME, TITLE = "campaign", "Sweeps, and 10^9 collisions"
BILLION, ROWS = 10**9, 100_000
CORES = (1, 8, 64, 512)


def measure(quick: bool) -> dict[str, Any]:
    """Costs of the stages, each by itself."""
    rows = [_rig(label, *rig, quick=quick) for label, rig in RIGS.items()]
    with LocalPool(2) as pool:
        local = _per_task(pool, 50 if quick else 2000)
    dask = _dask(50 if quick else 2000)
    return {
        "rows": rows,
        "workers": on_workers(quick),
        "per_task": {"local pool": local, "Dask": dask},
        "estimate": _estimate(rows, dask or local),
    }


def _rig(label: str, robot: str, joints: str, *, quick: bool) -> dict[str, Any]:
    engine = engine_of(robot, joints)
    plan = engine.plan
    count = 500 if quick else 10_000
    columns = engine.columns(0, count)
    _, values = plan.columns(0, count)
    function = engine._function((0.0,), list(plan.keys))
    numbers = function.numbers(np.column_stack([values[k] for k in plan.keys]))

    def new_pose() -> None:
        engine._functions.clear()
        engine._function((1.0,), list(plan.keys))

    with tempfile.TemporaryDirectory() as scratch:
        found = costs(
            {
                "collisions": lambda: collide(function.structure, numbers),
                "whole part": lambda: engine.columns(0, count),
                "file": lambda: write_part(Path(scratch) / "part.parquet", columns, {}),
                "pose": new_pose,
            },
            repeats=3 if quick else 5,
        )
        size = (Path(scratch) / "part.parquet").stat().st_size
    return {
        "rig": label,
        "collisions": count,
        "touches": float(columns["touches"].mean()),
        "seconds": as_json(found),
        "us_per_collision": 1e6 * found["collisions"].median / count,
        "us_in_a_part": 1e6 * (found["whole part"].median + found["file"].median) / count,
        "per_second": count / (found["whole part"].median + found["file"].median),
        "ms_per_pose": 1e3 * found["pose"].median,
        "bytes_per_collision": size / count,
    }


def nothing(task: int) -> int:
    """A task without work."""
    return task


def _per_task(executor: Executor, count: int) -> float:
    """Processor time [s] that a task without work costs this process: the caller, and Dask's scheduler with it."""
    _drain(executor, range(20))
    begun = time.process_time()
    _drain(executor, range(count))
    return (time.process_time() - begun) / count


def _drain(executor: Executor, tasks: Iterable[int]) -> None:
    for _ in executor.run(nothing, tasks):
        pass


def _dask(count: int) -> float | None:
    try:
        import distributed
    except ImportError:
        return None
    from spacerobot.support.executors.cluster import DaskWorkers

    options: dict[str, Any] = {"host": "127.0.0.1", "dashboard_address": None, "silence_logs": 50}
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, **options) as cluster,
        DaskWorkers(cluster.scheduler_address) as workers,
    ):
        return _per_task(workers, count)


def _estimate(rows: list[dict[str, Any]], per_task: float) -> list[dict[str, Any]]:
    """Hours of 10^9 collisions: work over cores, tasks one after the other through the scheduler."""
    tasks = math.ceil(BILLION / ROWS)
    found = []
    for row in rows:
        work = BILLION * 1e-6 * row["us_in_a_part"] + 20 * 1e-3 * row["ms_per_pose"]
        for cores in CORES:
            found.append(
                {
                    "rig": row["rig"],
                    "cores": cores,
                    "tasks": tasks,
                    "core_hours": work / 3600.0,
                    "hours": max(work / cores, tasks * per_task) / 3600.0,
                    "scheduling_share": tasks * per_task / (work / cores),
                    "gigabytes": BILLION * row["bytes_per_collision"] / 1e9,
                }
            )
    return found


def page(found: dict[str, Any]) -> str:
    """Markdown."""
    lines = [
        "| rig | touches | us per collision | with table and file | per second and core | ms per pose | bytes |",
        "|---|---|---|---|---|---|---|",
    ]
    for r in found["rows"]:
        lines.append(
            f"| {r['rig']} | {r['touches']:.1f} | {r['us_per_collision']:.0f} | {r['us_in_a_part']:.0f} "
            f"| {r['per_second']:,.0f} | {r['ms_per_pose']:.0f} | {r['bytes_per_collision']:.0f} |"
        )
    lines += workers_table(found["workers"])
    tasks = found["per_task"]
    dask = "not installed" if tasks["Dask"] is None else f"{1e3 * tasks['Dask']:.2f} ms"
    lines += [
        "",
        f"A task without work costs the caller {1e3 * tasks['local pool']:.2f} ms with the local pool, {dask} with Dask, the",
        "scheduler included (processor time; two worker processes on loopback).",
        "",
        f"**10^9 collisions on paper**, in parts of {ROWS:,}: work divided by cores, or the tasks one after the other",
        "through the scheduler, whichever is longer; the wait for the last part and the file system are not in it. Longer",
        "parts (`rows_per_part`, up to 2,000,000) make the scheduler's share so many times smaller.",
        "",
        "| rig | cores | core hours | hours | scheduling against work | GB |",
        "|---|---|---|---|---|---|",
    ]
    for e in found["estimate"]:
        lines.append(
            f"| {e['rig']} | {e['cores']} | {e['core_hours']:.1f} | {e['hours']:.3g} "
            f"| {100 * e['scheduling_share']:.2g} % | {e['gigabytes']:.0f} |"
        )
    return "\n".join(lines)
