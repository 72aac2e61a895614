"""Other processes as tests see them: whether they live, who descends from whom, and what becomes true in time."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable
from pathlib import Path

PATIENCE = 120.0
"""How long [s] a test waits for what must become true; only a failure takes that long."""


def eventually(true: Callable[[], object], seconds: float = PATIENCE, every: float = 0.02) -> bool:
    """Whether it becomes true in time."""
    until = time.monotonic() + seconds
    while not true():
        if time.monotonic() > until:
            return False
        time.sleep(every)
    return True


def alive(process: int) -> bool:
    """Whether it runs (a zombie does not)."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def gone(processes: Iterable[int], seconds: float = PATIENCE) -> bool:
    """Whether all of them end in time."""
    return eventually(lambda: not any(alive(p) for p in processes), seconds)


def family(process: int) -> set[int]:
    """The processes that descend from one."""
    found: set[int] = set()
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(stat.read_text().rsplit(")", 1)[1].split()[1])
        except (OSError, IndexError):
            continue
        if parent == process:
            found |= {int(stat.parent.name)} | family(int(stat.parent.name))
    return found


def busy_for(process: int) -> float:
    """Seconds of the processor's time that it has had."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def written(path: Path, seconds: float = PATIENCE) -> str:
    """What a file that another process makes says, once it says anything."""
    assert eventually(lambda: path.exists() and path.read_text(), seconds), f"nobody wrote {path.name}"
    return path.read_text()
