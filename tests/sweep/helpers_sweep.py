"""Small sweeps, and how their tables are compared."""

from __future__ import annotations

from pathlib import Path

from spacerobot.cli.main import main

SWEEP = """\
format = 1
title = "small"
seed = 3
repeats = 20
rows_per_part = 64
[scene]
robot = "chaser_pa10_wrist"
joints = "free"
[scene.wrist]
equivalent_damping = 9.69
[poses]
count = 2
spread_deg = 15
[grid]
"target.mass" = { from = 5.0, to = 200.0, count = 3, log = true }
target.speed = [0.03, 0.07]
wrist.stiffness = [530.0, 1020.0]
[scatter]
"target.speed" = { normal = 0.05 }
"contact.stiffness" = { uniform = 0.2 }
"""
TOTAL = 2 * 3 * 2 * 2 * 20


def write(folder: Path, text: str = SWEEP) -> Path:
    path = folder / "sweep.toml"
    path.write_text(text, encoding="utf-8")
    return path


def sweep(path: Path, out: Path, *options: str) -> int:
    return main(["sweep", str(path), "--out", str(out), *options])


def files(out: Path) -> dict[str, bytes]:
    """Everything that a finished sweep holds, marker and lock aside."""
    kept = (p for p in sorted(out.rglob("*")) if p.is_file() and p.name not in ("run.json", ".lock"))
    return {str(p.relative_to(out)): p.read_bytes() for p in kept}


def table(out: Path):
    import pyarrow.dataset as ds  # here, since SWEEP is of use where it is not installed

    return ds.dataset(out / "collisions", format="parquet").to_table().sort_by("collision").to_pydict()
