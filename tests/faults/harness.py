"""Faults done for real: a process is killed, interrupted, or refused by the disk, at its n-th step in a folder."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

KILL, INTERRUPT, DISK_FULL, READ_ERROR = "kill -9", "Ctrl-C", "disk full", "read-only"

_CHILD = """
import errno, os, signal, sys

folder, fault, at = sys.argv[1], sys.argv[2], int(sys.argv[3])
arguments = sys.argv[4:]
steps = 0
MAKING = os.O_WRONLY | os.O_RDWR | os.O_CREAT

def step(event, args):
    global steps
    if event == "open":
        if not isinstance(args[0], str) or not isinstance(args[2], int) or not args[2] & MAKING:
            return
    elif event not in ("os.rename", "os.remove", "os.mkdir", "os.chmod"):
        return
    if not isinstance(args[0], str) or not args[0].startswith(folder):
        return
    steps += 1
    if steps != at:
        return
    print("fault", file=sys.stderr, flush=True)
    if fault == "kill -9":
        os.kill(os.getpid(), signal.SIGKILL)
    if fault == "Ctrl-C":
        signal.raise_signal(signal.SIGINT)
    if fault == "disk full":
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), args[0])
    if fault == "read-only":
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), args[0])

sys.addaudithook(step)
signal.signal(signal.SIGINT, signal.default_int_handler)
from spacerobot.cli.main import entry
sys.argv = ["spacerobot", *arguments]
try:
    entry()
finally:
    print("steps", steps, file=sys.stderr, flush=True)
"""


def command(
    arguments: list[str], folder: Path, fault: str = "none", at: int = 0, temporary: Path | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a command; at its `at`-th step in `folder` (a file opened to write, renamed, removed) the fault happens.

    `temporary` stands for the system's temporary folder.
    """
    elsewhere = {} if temporary is None else {"TMPDIR": str(temporary)}
    return subprocess.run(
        [sys.executable, "-c", _CHILD, str(folder), fault, str(at), *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        env={**os.environ, "MPLBACKEND": "Agg", **elsewhere},
        timeout=900,
    )


def steps_of(done: subprocess.CompletedProcess[str]) -> int:
    """How many steps a run without a fault took."""
    return int(done.stderr.rsplit("steps ", 1)[1].split()[0])


def state(folder: Path) -> str:
    """What the folder says of its run: "nothing", "running" or "finished"; asserts that what it says is true."""
    marker = folder / "run.json"
    if not marker.exists():
        assert not folder.exists() or {p.name for p in folder.iterdir()} <= {".lock"} | _left_by_mkstemp(folder)
        return "nothing"
    said = json.loads(marker.read_text(encoding="utf-8"))  # whole, or json would not load it
    if said["state"] == "finished":
        for name, size in said["outputs"].items():
            assert (folder / name).stat().st_size == size, f"{name} is not what a finished run left"
    return str(said["state"])


def whole(folder: Path, reference: dict[str, bytes]) -> None:
    """Every output that is there under its own name is all there."""
    for name in reference:
        path = folder / name
        if path.exists() and path.suffix in (".json", ".html", ".toml", ".csv", ".png", ".svg", ".md"):
            data = path.read_bytes()
            assert len(data) > 0, f"{name} is empty"
            end = reference[name].rstrip()[-6:]
            assert data.rstrip()[-6:] == end, f"{name} was cut off"


def outputs(folder: Path) -> dict[str, bytes]:
    """The files that a finished run calls its own."""
    said = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    assert said["state"] == "finished"
    return {name: (folder / name).read_bytes() for name in said["outputs"]}


def _left_by_mkstemp(folder: Path) -> set[str]:
    return {p.name for p in folder.glob(".*.part")}
