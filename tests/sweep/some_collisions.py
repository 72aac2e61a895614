"""`python -m tests.sweep.some_collisions OUT.npz`: small sweeps, computed in every way, as arrays."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from spacerobot.sweep.engine import Engine
from spacerobot.sweep.sweep_file import plan_from_text

VARIED = """
seed = 3
repeats = 2
[poses]
count = 2
spread_deg = 15
[grid]
target.mass = [5.0, 50.0]
wrist.stiffness = [530.0, 1020.0]
[scatter]
"target.speed" = { normal = 0.05 }
"contact.stiffness" = { uniform = 0.2 }
"""
ONE = """
seed = 3
[poses]
count = 2
spread_deg = 15
[scatter]
"target.speed" = { normal = 0.05 }
"""
HELD = '[scene]\nrobot = "pa10_wrist"\n[scene.wrist]\nequivalent_damping = 9.69\n'
FREE = '[scene]\nrobot = "chaser_pa10_wrist"\njoints = "free"\n{}[scene.wrist]\nequivalent_damping = 9.69\n'
SWEEPS = {
    "exact, held": VARIED + HELD,
    "exact, free": VARIED + FREE.format(""),
    "reduced, integrated": VARIED + HELD + '[scene.contact]\nlaw = "hertz"\n',
    "multibody, held": ONE + HELD.replace("[scene.wrist]", 'backend = "multibody"\n[scene.wrist]'),
    "multibody, free": ONE + FREE.format('backend = "multibody"\n'),
}


def tables() -> dict[str, np.ndarray]:
    """Column of a sweep -> values."""
    found = {}
    for name, text in SWEEPS.items():
        plan = plan_from_text(text, Path("."))
        for column, values in Engine(plan).columns(0, plan.total).items():
            found[f"{name}: {column}"] = values
    return found


if __name__ == "__main__":
    np.savez(sys.argv[1], **tables())
