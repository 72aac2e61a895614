"""Trials a second: the full multibody model, the reduced one integrated, and the reduced one propagated exactly."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.timing import Cost, as_json, costs, with_quartiles
from spacerobot.model.library import load
from spacerobot.simulation.exact.batch import collide
from spacerobot.simulation.exact.structure import piecewise_linear
from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.parts import Target, Wrist
from spacerobot.simulation.reduced.run import simulate as simulate_reduced
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import default_duration, reduced_start, simulate

NAME, TITLE = "trials", "Trials a second"
WRIST, TARGET = Wrist(stiffness=530.0, equivalent_damping=9.69), Target(mass=9.0, speed=0.07)
SCENES = {
    "held arm": ("pa10_wrist", "locked"),
    "ground arm, joints free": ("pa10_wrist", "free"),
    "free chaser, joints free": ("chaser_pa10_wrist", "free"),
}
LOOSE = 1e-3
"""Tolerance of both integrations: restitution then agrees to about that."""

BATCH = 2000


def measure(quick: bool) -> dict[str, Any]:
    """Time per trial, and the restitution that each way finds."""
    rows = []
    batch = 50 if quick else BATCH
    for label, (robot, joints) in SCENES.items():
        scene = Scene(load(robot), joints=joints, wrist=WRIST, target=TARGET, backend="reduced")
        mechanism, end = scene.mechanism("reduced"), default_duration(scene)
        position, velocity = reduced_start(scene)
        structure, numbers = piecewise_linear(scene)
        many = np.tile(numbers, (batch, 1))

        def multibody(scene=scene, end=end) -> object:
            return integrate_scene(scene, end, tolerance=LOOSE)

        def reduced(mechanism=mechanism, position=position, velocity=velocity, end=end) -> object:
            return simulate_reduced(mechanism, position=position, velocity=velocity, end=end, tolerance=LOOSE)

        def exact(structure=structure, many=many) -> object:
            return collide(structure, many)

        found = costs({"multibody": multibody, "reduced": reduced, "exact": exact}, repeats=3 if quick else 7)
        each = found["exact"]
        found["exact"] = Cost(each.median / batch, each.low / batch, each.high / batch)
        restitution = {
            "multibody, 1e-10": simulate(scene, backend="multibody", tolerance=1e-10).restitution.hand,
            "multibody": simulate(scene, backend="multibody", tolerance=LOOSE).restitution.hand,
            "reduced": simulate(scene, tolerance=LOOSE).restitution.hand,
            "exact": float(collide(structure, numbers[None]).restitution_hand[0]),
        }
        rows.append({"scene": label, "seconds": as_json(found), "restitution": restitution})
    return {"rows": rows}


def page(found: dict[str, Any]) -> str:
    """Markdown."""
    lines = [
        f"Both integrations at tolerance {LOOSE:g}; the exact propagation has none. Restitution is that of target against",
        "hand; the reduced model takes a moving arm for one constant mass, which is its own error. Target: the reduced",
        "model at least 100 times faster than the multibody one, restitution equal to 1e-3.",
        "",
        "| scene | | ms a trial | trials a second | times the multibody | restitution | off the multibody at 1e-10 |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in found["rows"]:
        full = row["seconds"]["multibody"]["median"]
        true = row["restitution"]["multibody, 1e-10"]
        for way in ("multibody", "reduced", "exact"):
            own = row["seconds"][way]["median"]
            e = row["restitution"][way]
            lines.append(
                f"| {row['scene']} | {way} | {with_quartiles(row['seconds'][way], 1e3)} | {1.0 / own:,.0f} "
                f"| {full / own:,.1f} | {e:.6f} | {abs(e - true):.1e} |"
            )
    return "\n".join(lines)
