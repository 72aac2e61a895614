"""Effective mass of many poses, beside the Pinocchio calls that it cannot do without."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.timing import as_json, costs
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
    begun = time.process_time()
    effective_mass_batch(robot, poses)
    return {"rows": rows, "all": {"poses": million, "seconds": time.process_time() - begun, "robot": ROBOTS[0]}}


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
        lines.append(
            f"| {row['robot']} | {row['poses']} | {row['us_per_pose']:.2f} | {row['us_bare']:.2f} | {row['ratio']:.2f} |"
        )
    whole = found["all"]
    lines += ["", f"{whole['poses']:,} poses of {whole['robot']}: {whole['seconds']:.2f} s of one core."]
    return "\n".join(lines)
