"""One right-hand side of the multibody backend, as a ratio to one `pin.aba` of the same model."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.timing import as_json, costs, with_quartiles
from spacerobot.model.library import load
from spacerobot.simulation.multibody.assembly import assemble_bodies
from spacerobot.simulation.multibody.dynamics import Dynamics
from spacerobot.simulation.scene import Scene

NAME, TITLE = "right_hand_side", "One multibody right-hand side"
SCENES = {
    "held arm": ("pa10_wrist", "locked"),
    "ground arm, joints free": ("pa10_wrist", "free"),
    "free chaser, joints free": ("chaser_pa10_wrist", "free"),
}


def measure(quick: bool) -> dict[str, Any]:
    """Ratio in each scene."""
    rows = []
    for label, (robot, joints) in SCENES.items():
        scene = Scene(load(robot), joints=joints)
        mechanism = scene.mechanism("multibody")
        assembly = assemble_bodies(scene, mechanism)
        dynamics = Dynamics(assembly, mechanism)
        y, out = np.zeros(dynamics.size), np.empty(dynamics.size)
        y[: dynamics.nq] = assembly.configuration
        y[dynamics.nq : dynamics.nq + dynamics.nv] = assembly.velocity
        model, data = assembly.model, assembly.model.createData()
        q, v, tau = np.array(assembly.configuration), np.array(assembly.velocity), np.zeros(model.nv)
        found = costs(
            {
                "pin.aba": lambda: pin.aba(model, data, q, v, tau),  # noqa: B023 - called before the loop goes on
                "spacerobot": lambda: dynamics.rate(0.0, y, out),  # noqa: B023
            },
            repeats=3 if quick else 11,
        )
        rows.append(
            {
                "scene": label,
                "degrees_of_freedom": model.nv,
                "seconds": as_json(found),
                "ratio": found["spacerobot"].median / found["pin.aba"].median,
            }
        )
    return {"rows": rows}


def page(found: dict[str, Any]) -> str:
    """Markdown."""
    lines = [
        "Both called from Python. The right-hand side is more than forward dynamics: ports, contact, friction, the energy",
        "ledger, quaternions; a compiled recursion over the model's tree of joints. Targets: 2 (held arm), 1.25 (20 degrees of freedom).",
        "",
        "| scene | degrees of freedom | right-hand side, us | pin.aba, us | ratio |",
        "|---|---|---|---|---|",
    ]
    for row in found["rows"]:
        own, bare = row["seconds"]["spacerobot"], row["seconds"]["pin.aba"]
        lines.append(
            f"| {row['scene']} | {row['degrees_of_freedom']} | {with_quartiles(own, 1e6)} "
            f"| {with_quartiles(bare, 1e6)} | {row['ratio']:.1f} |"
        )
    return "\n".join(lines)
