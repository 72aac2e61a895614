"""The sweep that is measured, and how many collisions a second worker processes make of it."""

from __future__ import annotations

import contextlib
import functools
from pathlib import Path
from typing import Any

from benchmarks.timing import all_cores, on_cores, with_quartiles
from spacerobot.support.executors.base import Executor
from spacerobot.support.executors.local import LocalPool
from spacerobot.sweep.engine import Engine
from spacerobot.sweep.sweep_file import plan_from_text

SWEEP = """
repeats = 1_000_000
seed = 1
[scene]
robot = "{robot}"
joints = "{joints}"
[scene.wrist]
equivalent_damping = 9.69
[poses]
count = 20
spread_deg = 15.0
[grid]
target.mass = [5.0, 20.0, 100.0]
target.speed = [0.03, 0.07]
wrist.stiffness = [530.0, 1020.0]
[scatter]
"target.speed" = {{ normal = 0.05 }}
"contact.stiffness" = {{ uniform = 0.2 }}
"wrist.stiffness" = {{ uniform = 0.05 }}
"""
RIGS = {"held arm": ("pa10_wrist", "locked"), "free chaser": ("chaser_pa10_wrist", "free")}
PARTS = 8


@functools.cache
def engine_of(robot: str, joints: str) -> Engine:
    """What computes the sweep of a rig."""
    return Engine(plan_from_text(SWEEP.format(robot=robot, joints=joints), Path(".")))


def stretch(task: tuple[str, int, int]) -> int:
    """In a worker: collisions first to last - 1 of a rig; how many there were."""
    label, first, last = task
    return int(engine_of(*RIGS[label]).columns(first, last)["collision"].size)


def on_workers(quick: bool) -> dict[str, Any]:
    """The same collisions by one worker process, by two, and by as many as there are cores."""
    label, size = "held arm", 500 if quick else 5_000
    tasks = [(label, size * i, size * (i + 1)) for i in range(PARTS)]

    def work(pool: Executor) -> None:
        for _ in pool.run(stretch, tasks):
            pass

    with all_cores() as available, contextlib.ExitStack() as stack:
        pools = {n: stack.enter_context(LocalPool(n)) for n in sorted({1, 2, available}) if n <= available}
        rows = on_cores({n: functools.partial(work, pool) for n, pool in pools.items()}, repeats=2 if quick else 5)
    return {"rig": label, "collisions": size * PARTS, "rows": rows}


def workers_table(found: dict[str, Any]) -> list[str]:
    """Markdown lines of what `on_workers` found."""
    one, count = found["rows"][0], found["collisions"]
    lines = [
        "",
        f"{count:,} collisions of the {found['rig']} in {PARTS} parts, by processes of `--jobs` (wall time; files are not written):",
        "",
        "| processes | wall, s | collisions a second | of the least wall | speed-up of the least |",
        "|---|---|---|---|---|",
    ]
    for row in found["rows"]:
        least = row["least_wall"]
        lines.append(
            f"| {row['cores']} | {with_quartiles(row['wall'])} | {count / row['wall']['median']:,.0f} "
            f"| {count / least:,.0f} | {one['least_wall'] / least:.2f} |"
        )
    return lines
