"""Work-precision of one collision: error in restitution and contact time against processor time."""

from __future__ import annotations

import importlib
import math
import time
from collections.abc import Callable
from typing import Any

from benchmarks.engines.meeting import DURATION, SCENES, WRIST, Outcome
from benchmarks.timing import Cost, spread, with_quartiles

NAME, TITLE = "collision", "One collision: work against precision"
ENGINES = ("ours", "by_mujoco", "by_drake", "by_scipy")
LEVELS = (1e-3, 1e-4, 1e-6)
ENOUGH = 0.1
"""Processor time [s] after which a setting has been repeated enough; a run three times as long is made once."""


def measure(quick: bool) -> dict[str, Any]:
    """Error and time of every engine and setting, in both scenes."""
    scenes = []
    for name in SCENES:
        reference = importlib.import_module("benchmarks.engines.ours").reference(name)
        rows = []
        for engine in ENGINES:
            try:
                runs = list(importlib.import_module(f"benchmarks.engines.{engine}").runs(name, quick))
            except ImportError as error:
                rows.append(
                    {"engine": engine, "setting": f"not installed: {error.name}", "error": None, "seconds": None}
                )
                continue
            for label, setting, run in runs:
                found, cost = _timed(run)
                error = found.error(reference)
                rows.append(
                    {
                        "engine": label,
                        "setting": setting,
                        "error": error if math.isfinite(error) else None,
                        "restitution": found.restitution,
                        "contact_time": found.contact_time if math.isfinite(found.contact_time) else None,
                        "seconds": cost.median,
                        "low": cost.low,
                        "high": cost.high,
                    }
                )
        scenes.append(
            {
                "scene": name,
                "restitution": reference.restitution,
                "contact_time": reference.contact_time,
                "rows": rows,
            }
        )
    return {"scenes": scenes}


def _timed(run: Callable[[], Outcome]) -> tuple[Outcome, Cost]:
    """The outcome, and the processor time [s]; the first run does not count where others are affordable."""
    begun = time.process_time()
    found = run()
    taken = [time.process_time() - begun]
    if taken[0] < 3.0 * ENOUGH:
        taken = []
        while sum(taken) < ENOUGH or len(taken) < 3:
            begun = time.process_time()
            run()
            taken.append(time.process_time() - begun)
    return found, spread(taken)


def _spent(row: dict[str, Any]) -> str:
    """Of a row, in ms."""
    return with_quartiles({"median": row["seconds"], **{k: row[k] for k in ("low", "high") if k in row}}, 1e3)


def _family(engine: str) -> str:
    return engine if engine.startswith("spacerobot") else engine.split()[0]


def best(rows: list[dict[str, Any]], level: float) -> dict[str, dict[str, Any]]:
    """Family -> its fastest row whose error is at most the level."""
    found: dict[str, dict[str, Any]] = {}
    for row in rows:
        if row["error"] is None or row["error"] > level:
            continue
        family = _family(row["engine"])
        if family not in found or row["seconds"] < found[family]["seconds"]:
            found[family] = row
    return found


def page(found: dict[str, Any]) -> str:
    """Markdown."""
    lines = [
        f"A target of 9 kg at 7 cm/s, wrist {WRIST.stiffness:g} N/m and {WRIST.equivalent_damping:g} N s/m, contact spring",
        f"68 000 N/m without dissipation, {DURATION:g} s simulated. The error is the larger of the relative errors of",
        "restitution and contact time (first touch to last separation), against our multibody backend at 1e-12. MuJoCo,",
        "which shares no code with ours, converges to the same values, so the reference is its as well.",
        "",
        "* MuJoCo runs its steps inside `rollout`. *Spring*: the contact as a tendon with a dead band, an exact one-sided",
        "  spring. *Own contact*: `solref` and `solimp` set from its own `efc_R` and `efc_diagA` so that it pushes as the",
        "  spring does, at the least impedance it takes; its stiffness is then right to some 1e-4.",
        "* Drake: point contact of a sphere and a half space, both twice as stiff; dissipation 0. Discrete: each contact",
        "  approximation; continuous: each integrator, at several accuracies.",
        "* scipy: `solve_ivp` over `pin.aba` in Python, contact as max(0, k d).",
        "* Ours: *exact* propagates by matrix exponentials between events, *reduced* is what fits and sweeps integrate. Of a",
        "  held arm nothing moves but wrist and target, so there both are the multibody model's physics; for moving joints",
        "  they are approximations, and left out.",
        "* The last separation of the others is interpolated between steps by a parabola. Setting up is not counted: of the",
        "  others the model, of the reduced backend its mechanism. The exact way takes its numbers from the scene in every",
        "  run, and the multibody backend keeps the bodies of its scene between runs.",
        "* Brackets: quartiles of the repeats; a run of more than 0.3 s is made once.",
    ]
    for scene in found["scenes"]:
        lines += ["", f"### {scene['scene']}", ""]
        lines.append(f"Restitution {scene['restitution']:.9f}, contact time {scene['contact_time']:.9f} s.")
        lines += _reached(scene["rows"])
        lines += [
            "",
            '<details markdown="1"><summary>every setting</summary>',
            "",
            "| engine | setting | error | ms |",
            "|---|---|---|---|",
        ]
        for row in scene["rows"]:
            error = "-" if row["error"] is None else f"{row['error']:.1e}"
            spent = "-" if row["seconds"] is None else _spent(row)
            lines.append(f"| {row['engine']} | {row['setting']} | {error} | {spent} |")
        lines += ["", "</details>"]
    return "\n".join(lines)


def _reached(rows: list[dict[str, Any]]) -> list[str]:
    """Fastest way of each family to each level, in ms, and how many times faster ours is than the best other."""
    families = list(dict.fromkeys(_family(r["engine"]) for r in rows if r["seconds"] is not None))
    lines = ["", "| fastest to reach, ms | " + " | ".join(f"{level:g}" for level in LEVELS) + " |"]
    lines.append("|---|" + "---|" * len(LEVELS))
    for family in families:
        cells = []
        for level in LEVELS:
            row = best(rows, level).get(family)
            how = "" if row is None or row["engine"] == family else row["engine"].split(" ", 1)[1] + ", "
            cells.append("not reached" if row is None else f"{_spent(row)}: {how}{row['setting']}")
        lines.append(f"| {family} | " + " | ".join(cells) + " |")
    for own in (f for f in families if f.startswith("spacerobot")):
        cells = []
        for level in LEVELS:
            there = best(rows, level)
            others = [r["seconds"] for f, r in there.items() if not f.startswith("spacerobot")]
            if own not in there:
                cells.append("-")
            elif not others:
                cells.append("no other reaches it")
            else:
                cells.append(f"{min(others) / there[own]['seconds']:.3g}")
        lines.append(f"| **{own}: times faster than the best other** | " + " | ".join(cells) + " |")
    return lines
