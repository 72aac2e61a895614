"""Effective mass of many poses, beside the Pinocchio calls that it cannot do without."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.timing import all_cores, as_json, costs, on_cores, with_quartiles
from spacerobot.dynamics.batch import effective_mass_batch
from spacerobot.model.library import load

NAME, TITLE = "effective_mass", "Effective mass of many poses"
ROBOTS = ("pa10_wrist", "chaser_pa10_wrist")


def measure(quick: bool) -> dict[str, Any]:
    """Time per pose, and how it grows with the number of poses."""
    rows = []
    for name in ROBOTS:
        robot = load(name)
        count = 500 if quick else 20_000
        poses = np.random.default_rng(1).uniform(-1.0, 1.0, (count, len(robot.chain)))
        model, data = robot.model, robot.model.createData()
        frame = robot.frame_id(robot.tip)
        configurations = [robot.configuration(p) for p in poses]

        def bare(model=model, data=data, frame=frame, configurations=configurations) -> None:
            for q in configurations:
                pin.crba(model, data, q)
                pin.computeJointJacobians(model, data, q)
                pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)

        def ours(robot=robot, poses=poses) -> None:
            effective_mass_batch(robot, poses)

        found = costs({"pinocchio": bare, "spacerobot": ours}, repeats=3 if quick else 7)
        rows.append(
            {
                "robot": name,
                "poses": count,
                "seconds": as_json(found),
                "us_per_pose": 1e6 * found["spacerobot"].median / count,
                "us_bare": 1e6 * found["pinocchio"].median / count,
                "ratio": found["spacerobot"].median / found["pinocchio"].median,
            }
        )
    million = 2_000 if quick else 1_000_000
    robot = load(ROBOTS[0])
    poses = np.random.default_rng(2).uniform(-1.0, 1.0, (million, len(robot.chain)))
    with all_cores() as available:
        calls = {
            threads: lambda threads=threads: effective_mass_batch(robot, poses, threads=threads)
            for threads in sorted({1, 2, available})
            if threads <= available
        }
        cores = on_cores(calls, repeats=2 if quick else 7)
    return {"rows": rows, "cores": {"robot": ROBOTS[0], "poses": million, "rows": cores}}


def page(found: dict[str, Any]) -> str:
    """Markdown."""
    lines = [
        "`crba`, `computeJointJacobians` and `getFrameJacobian` through Python, beside `effective_mass_batch`, which walks",
        "the tree in compiled code and needs none of them. Target: at most 2.",
        "",
        "| robot | poses | us per pose | bare Pinocchio calls, us | ratio |",
        "|---|---|---|---|---|",
    ]
    for row in found["rows"]:
        own, bare = (with_quartiles(row["seconds"][side], 1e6 / row["poses"]) for side in ("spacerobot", "pinocchio"))
        lines.append(f"| {row['robot']} | {row['poses']} | {own} | {bare} | {row['ratio']:.2f} |")
    return "\n".join([*lines, *_cores(found["cores"])])


def _cores(found: dict[str, Any]) -> list[str]:
    one = found["rows"][0]
    lines = [
        "",
        f"{found['poses']:,} poses of {found['robot']}, wall time, by `threads`: the poses are cut into as many blocks, and",
        "results are equal to the last bit. Target: linear in cores. Other work on the machine takes cores away, so the least",
        "counts; the processor time of all threads together would grow if they were in each other's way.",
        "",
        "| threads | wall, s | least, s | speed-up | of the least | processor, s |",
        "|---|---|---|---|---|---|",
    ]
    for row in found["rows"]:
        lines.append(
            f"| {row['cores']} | {with_quartiles(row['wall'])} | {row['least_wall']:.3g} "
            f"| {one['wall']['median'] / row['wall']['median']:.2f} | {one['least_wall'] / row['least_wall']:.2f} "
            f"| {with_quartiles(row['processor'])} |"
        )
    return lines
    return "\n".join(lines)
