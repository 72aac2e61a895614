"""The long run: python -m fuzz [--cases N] [--folder DIR] [TARGET ...], also as make fuzz.

Each target runs in a process of its own until it has had its share of the cases; a run that was interrupted goes on
where it stopped. Ends with fuzz/results.json and exit code 1 if there is any defect.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
import subprocess
import sys
import time
from pathlib import Path

from fuzz.binary.kinds import KINDS
from fuzz.tally import Tally
from fuzz.targets import TARGETS
from fuzz.watch import SCRATCH, scratch

HERE = Path(__file__).resolve().parent


def main() -> int:
    """Run what is asked for, one target after the other, and report."""
    parser = argparse.ArgumentParser(prog="python -m fuzz")
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=f"of {', '.join((*TARGETS, *KINDS))}; all if none")
    parser.add_argument("--cases", type=int, help="in all, instead of each target's own number")
    parser.add_argument("--folder", type=Path, default=HERE / "run", help="corpus, counts and findings")
    parser.add_argument("--results", type=Path, default=HERE / "results.json")
    args = parser.parse_args()
    shares = {name: each.cases for name, each in (*TARGETS.items(), *KINDS.items())}
    names = args.targets or list(shares)
    unknown = [name for name in names if name not in shares]
    if unknown:
        parser.error(f"no such target: {', '.join(unknown)}")
    scale = args.cases / sum(shares[name] for name in names) if args.cases else 1.0
    for name in names:
        run(name, args.folder.resolve() / name, round(scale * shares[name]))
    return report(args.folder.resolve(), list(shares), args.results)


def run(name: str, folder: Path, cases: int) -> None:
    """Run a target until it has had its cases; the fuzzer's process may die on one, which is then a defect."""
    module = "fuzz.cover" if name in TARGETS else "fuzz.containers"
    folder.mkdir(parents=True, exist_ok=True)
    while (before := Tally(folder).tried) < cases:
        began = time.monotonic()
        work = scratch(name)
        with (folder / "log").open("ab") as log:
            command = [sys.executable, "-B", "-m", module, name, str(folder), str(cases)]
            own = {**environment(), SCRATCH: str(work)}
            done = subprocess.run(command, stdout=log, stderr=log, cwd=HERE.parent, env=own, check=False)
        shutil.rmtree(work, ignore_errors=True)
        tally = Tally(folder)
        for killed in folder.glob("killed-*"):
            words = f"the fuzzer's process ended: {killed.name.split('-')[1]}"
            tally.add("defect", words, 0.0, killed.read_bytes())
            killed.rename(folder / f"was-{killed.name}")
        seconds = time.monotonic() - began
        print(f"{name}: {tally.tried} cases, {len(tally.defects)} defects, {seconds:.0f} s", flush=True)
        if tally.tried == before:
            sys.exit(f"{name} did nothing (exit {done.returncode}): see {folder / 'log'}")


def environment() -> dict[str, str]:
    """One thread; nothing of the user's that a study could name."""
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return {**{k: v for k, v in os.environ.items() if not k.startswith("SPACEROBOT_")}, **threads}


def report(folder: Path, names: list[str], results: Path) -> int:
    """Write the figures of all targets that ran; 1 if any has a defect."""
    tallies = {name: Tally(folder / name) for name in names if (folder / name).is_dir()}
    found = {
        "cases": sum(t.tried for t in tallies.values()),
        "most memory [MB]": round(max(t.memory for t in tallies.values()) / 1e6, 1),
        "slowest case [s]": round(max(t.slowest for t in tallies.values()), 3),
        "defects": sum(len(t.defects) for t in tallies.values()),
        "python": platform.python_version(),
        "targets": {name: t.report() for name, t in tallies.items()},
    }
    results.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    summary = {key: found[key] for key in ("cases", "most memory [MB]", "slowest case [s]", "defects")}
    print(json.dumps(summary))
    return 1 if found["defects"] else 0


if __name__ == "__main__":
    sys.exit(main())
