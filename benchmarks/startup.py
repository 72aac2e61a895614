"""Start-up of the command: help, and the smallest answer."""

from __future__ import annotations

import resource
import subprocess
import sys
import time
from dataclasses import asdict
from typing import Any

from benchmarks.timing import spread

NAME, TITLE = "startup", "Start-up"
COMMANDS = {
    "spacerobot --help": (["--help"], 0.1),
    "spacerobot mass": (
        ["mass", "pa10_wrist", "--q", "0", "45", "0", "90", "0", "-45", "0", "--deg", "--direction", "1", "0", "0"],
        0.6,
    ),
}
"""Label -> (arguments, target [s])."""


def measure(quick: bool) -> dict[str, Any]:
    """Processor and wall time of each command."""
    rows = []
    repeats = 3 if quick else 9
    for label, (arguments, target) in COMMANDS.items():
        command = [sys.executable, "-m", "spacerobot", *arguments]
        run(command)  # fills the caches of files and of compiled code
        taken = [run(command) for _ in range(repeats)]
        rows.append(
            {
                "command": label,
                "target": target,
                "processor": asdict(spread([t[0] for t in taken])),
                "wall": asdict(spread([t[1] for t in taken])),
                "least_wall": min(t[1] for t in taken),
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
        "A child process each; wall time is that of the machine with whatever else it was doing, the least of it in brackets.",
        "",
        "| command | processor, s | wall, s (least) | target, s |",
        "|---|---|---|---|",
    ]
    for row in found["rows"]:
        own, wall = row["processor"], row["wall"]
        lines.append(
            f"| `{row['command']}` | {own['median']:.3f} ({own['low']:.3f} to {own['high']:.3f}) "
            f"| {wall['median']:.3f} ({row['least_wall']:.3f}) | {row['target']} |"
        )
    return "\n".join(lines)
