"""Start-up of the command: help, and the smallest answer."""

from __future__ import annotations

import resource
import subprocess
import sys
import time
from dataclasses import asdict
from typing import Any

from benchmarks.timing import all_cores, spread, with_quartiles

NAME, TITLE = "startup", "Start-up"
MASS = "mass pa10_wrist --q 0 45 0 90 0 -45 0 --deg --direction 1 0 0"
COMMANDS: dict[str, tuple[list[str], float | None]] = {
    "python -I -S -c pass": (["-I", "-S", "-c", "pass"], None),
    "python -c pass": (["-c", "pass"], None),
    'python -c "import numpy"': (["-c", "import numpy"], None),
    'python -c "import pinocchio"': (["-c", "import pinocchio"], None),
    "spacerobot --help": (["-m", "spacerobot", "--help"], 0.1),
    "spacerobot mass": (["-m", "spacerobot", *MASS.split()], 0.6),
}
"""Label -> (arguments of the interpreter, target [s] of the wall time)."""


def measure(quick: bool) -> dict[str, Any]:
    """Processor and wall time of each command."""
    rows = []
    repeats = 3 if quick else 25
    taken: dict[str, list[tuple[float, float]]] = {label: [] for label in COMMANDS}
    with all_cores():  # as a user would have them
        for round_ in range(repeats + 1):
            for label, (arguments, _) in COMMANDS.items():
                spent = run([sys.executable, *arguments])
                if round_:  # the first fills the caches of files and of compiled code
                    taken[label].append(spent)
    for label, (_, target) in COMMANDS.items():
        rows.append(
            {
                "command": label,
                "target": target,
                "processor": asdict(spread([t[0] for t in taken[label]])),
                "wall": asdict(spread([t[1] for t in taken[label]])),
                "least_wall": min(t[1] for t in taken[label]),
            }
        )
    return {"rows": rows}


def run(command: list[str]) -> tuple[float, float]:
    """Processor and wall time of a child [s]."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    wall, after = time.monotonic() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def page(found: dict[str, Any]) -> str:
    """Markdown."""
    lines = [
        "A child process each, in turns. Wall time is that of the machine with whatever else it was doing, so the least is",
        "the nearest to what an idle one would show. The interpreter alone is in every line below its own: without site,",
        "then with the `.pth` files of what is installed; `mass` cannot do without the two libraries.",
        "",
        "| command | wall, s | least | processor, s | target |",
        "|---|---|---|---|---|",
    ]
    for row in found["rows"]:
        target = "" if row["target"] is None else f"{row['target']:g}"
        lines.append(
            f"| `{row['command']}` | {with_quartiles(row['wall'], digits='.3f')} | {row['least_wall']:.3f} "
            f"| {with_quartiles(row['processor'], digits='.3f')} | {target} |"
        )
    return "\n".join(lines)
