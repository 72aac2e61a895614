"""`python -m benchmarks.run`: every benchmark, its numbers as JSON, and the page."""

from __future__ import annotations

import argparse
import importlib
import json
import os
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from benchmarks.timing import THREADS, pin_to_one_core, processor, versions

ROOT = Path(__file__).resolve().parent
BENCHMARKS = ("collision", "right_hand_side", "effective_mass", "trials", "diagnosis", "campaign", "startup", "where")
"""Modules with NAME, TITLE, `measure(quick) -> dict` and `page(found) -> str`, in the order of the page."""

_INTRODUCTION = """\
# Benchmarks

Written by `make bench`; the numbers, with the versions of everything that took part, lie in `benchmarks/results/`.

All ratios are taken within one run: both sides on the same core (`os.sched_setaffinity`), in turns, repeated; given are
medians, and in brackets the quartiles. The machine may be busy with other work, so times are **processor time** of a
single thread unless a line says wall time: what others do on the machine is not in them.
"""


def main(argv: list[str] | None = None) -> int:
    """Run benchmarks and write their page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help=f"only these: {', '.join(BENCHMARKS)}")
    parser.add_argument("--quick", action="store_true", help="small runs that show only that everything works")
    parser.add_argument("--results", type=Path, default=ROOT / "results")
    parser.add_argument("--page", type=Path, default=ROOT.parent / "docs" / "benchmarks.md")
    args = parser.parse_args(argv)
    unknown = [n for n in args.names if n not in BENCHMARKS]
    if unknown:
        parser.error(f"no such benchmark: {', '.join(unknown)}")
    for name in THREADS:  # numpy is not loaded yet: modules are imported below
        os.environ[name] = "1"
    core = pin_to_one_core()
    for name in args.names or BENCHMARKS:
        module = importlib.import_module(f"benchmarks.{name}")
        begun = time.monotonic()
        print(f"{name} ...", file=sys.stderr, flush=True)
        found = module.measure(args.quick)
        about = {
            "benchmark": name,
            "date": datetime.now(UTC).strftime("%Y-%m-%d"),
            "processor": processor(),
            "core": core,
            "quick": args.quick,
            "versions": versions(),
            "took_seconds": round(time.monotonic() - begun, 1),
        }
        _write(args.results / f"{name}.json", json.dumps({**about, "found": found}, indent=1) + "\n")
    _write(args.page, page(args.results))
    return 0


def page(results: Path) -> str:
    """The page of all results that are there."""
    parts = [_INTRODUCTION]
    for name in BENCHMARKS:
        path = results / f"{name}.json"
        if not path.exists():
            continue
        about: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        module = importlib.import_module(f"benchmarks.{name}")
        said = ", ".join(f"{k} {v}" for k, v in about["versions"].items())
        small = " A quick run: its numbers say little." if about["quick"] else ""
        parts.append(f"## {module.TITLE}\n\n{module.page(about['found'])}\n")
        parts.append(f"<sub>{about['date']}, {about['processor']}; {said}.{small}</sub>\n")
    return "\n".join(parts)


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
